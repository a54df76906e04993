// labels: gpu
// fraunhofer_mask on the GPU: against its reference, laws, billboards against transforms, zones, files, gate, states.
#include "base/image_io.h"
#include "perception/glare/fraunhofer_mask_tables.h"
#include "perception/glare/glare_gate_law.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"
#include "shaders/geometry.glsl"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

namespace entoptic::perception {
namespace {

using namespace testing;

const auto* validation_guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const char* name = "fraunhofer_mask";

constexpr float white = 130;

void fill(ImageF& image, int x, int y, int w, int h, float r, float g, float b) {
    for (int j = y; j < y + h; ++j)
        for (int i = x; i < x + w; ++i) image.at(i, j, 0) = r, image.at(i, j, 1) = g, image.at(i, j, 2) = b;
}
void fill(ImageF& image, int x, int y, int w, int h, float v) { fill(image, x, y, w, h, v, v, v); }

Selection model(std::vector<std::string> settings = {}) { return only({"glare=fraunhofer_mask"}, settings); }

// Frames of one view.
class Glare {
public:
    Glare(const EyeGeometry& g, const Selection& selection) : runner_({g}, selection) {}
    ImageF at(const ImageF& in, float pupil_mm = 4, float open = 1, bool snap = true, double dt_s = 1.0 / 90) {
        FrameInput input = still_input(1, dt_s, snap);
        input.eyes[0].pupil_diameter_mm = pupil_mm;
        input.eyes[0].eyelid_open = open;
        return runner_.run(in, input);
    }
    EffectOutcome outcome() { return runner_.stage().effects().at(0); }
    Stage& stage() { return runner_.stage(); }

private:
    StageRunner runner_;
};

ImageD reference(const ImageF& in, const EyeGeometry& g, const std::vector<std::string>& settings, float pupil = 4, float open = 1) {
    const Selection s = model(settings);
    ReferenceFrame frame{convert<double>(in), g, {}, {}, 1.0 / 90, true, 0, 1};
    frame.eye.pupil_diameter_mm = pupil;
    frame.eye.eyelid_open = open;
    frame.scene_white_cd_m2 = static_cast<double>(white);
    auto made = s.choices.at(0).entry->create_reference();
    check(made->set_files(s.choices.at(0).files));
    made->apply(frame, s.choices.at(0).parameters);
    return frame.image;
}

double luminance(const ImageF& image, int x, int y) {
    return 0.2126 * static_cast<double>(image.at(x, y, 0)) + 0.7152 * static_cast<double>(image.at(x, y, 1)) + 0.0722 * static_cast<double>(image.at(x, y, 2));
}
// Sum of added luminance in a wedge about the middle, azimuths modulo half a turn.
double in_wedge(const ImageF& out, const ImageF& in, int cx, int cy, double azimuth_deg, double half_deg, double inner, double outer) {
    double sum = 0;
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) {
            const double r = std::hypot(x - cx, y - cy), a = std::atan2(cy - y, x - cx) * 180 / 3.14159265358979 - azimuth_deg;
            if (r > inner && r < outer && std::abs(std::remainder(a, 180.0)) < half_deg) sum += luminance(out, x, y) - luminance(in, x, y);
        }
    return sum;
}

const std::vector<std::string> hexagon = {"glare.blades=6", "glare.lids=0", "glare.lashes=0"};
std::vector<std::string> with(std::vector<std::string> list, const std::vector<std::string>& more) {
    list.insert(list.end(), more.begin(), more.end());
    return list;
}

struct Scene {
    const char* what;
    ImageF image;
    std::vector<std::string> settings;
    float open;
    double most_relative, most_codes;      // of the mean errors: beside streaks, which the grid makes wider than a pixel, they are large
};

TEST(FraunhoferMask, GpuAndReferenceAgree) {
    const EyeGeometry g = rectilinear(25, 21, 2.0);      // 12.5 pixels a degree
    ImageF lamp = uniform(25, 21, 1);
    fill(lamp, 12, 10, 1, 1, 1e6f);
    ImageF coloured = uniform(25, 21, 1);
    fill(coloured, 12, 10, 1, 1, 1e6f, 4e5f, 1e5f);
    const Scene list[] = {
        {"round pupil", lamp, {"glare.texel_px=1"}, 1, 0.01, 0.3},
        {"lashes half closed", lamp, {"glare.texel_px=1"}, 0.55f, 0.1, 4},
        {"hexagon three lines", coloured, {"glare.texel_px=1", "glare.blades=6", "glare.lids=0", "glare.lashes=0", "glare.three_lines=1"}, 1, 0.3, 7},
        {"cross-screen filter", lamp, {"glare.texel_px=1", "glare.filter_directions=2", "glare.lids=0", "glare.lashes=0"}, 1, 0.4, 11},
    };
    for (const Scene& s : list) {
        const ImageF gpu = Glare(g, model(s.settings)).at(s.image, 4, s.open);
        const ImageD exact = reference(s.image, g, s.settings, 4, s.open);
        std::vector<double> errors;
        for (int y = 0; y < 21; ++y)
            for (int x = 0; x < 25; ++x)
                for (int c = 0; c < 3; ++c)
                    errors.push_back(relative_error(static_cast<double>(gpu.at(x, y, c)), exact.at(x, y, c), 2));
        const ErrorSummary e = summary(errors), display = summary(code_errors(gpu, exact));
        double got = 0, want = 0;
        for (std::size_t i = 0; i < gpu.data.size(); ++i) got += static_cast<double>(gpu.data[i] - s.image.data[i]), want += exact.data[i] - static_cast<double>(s.image.data[i]);
        ledger(name, s.what, "GPU against reference mean relative", e.mean);
        ledger(name, s.what, "GPU against reference p99 relative", e.p99);
        ledger(name, s.what, "GPU against reference mean codes", display.mean);
        ledger(name, s.what, "light added over reference's", got / want);
        EXPECT_LT(e.mean, s.most_relative) << s.what;
        EXPECT_LT(display.mean, s.most_codes) << s.what;
        EXPECT_NEAR(got / want, 1, 0.03) << s.what;
        if (std::getenv("ENTOPTIC_MASK_PRINT"))
            for (int y = 4; y < 17; ++y) {
                for (int x = 4; x < 21; ++x) std::printf("%8.1f/%-8.1f", static_cast<double>(gpu.at(x, y, 1)), exact.at(x, y, 1));
                std::printf("\n");
            }
    }
}

// A dark room, darker to the right, with a lamp of 2 x 2 pixels, at the headset's 13.85 pixels a degree.
ImageF dark_room(int width, int height) {
    ImageF room(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) fill(room, x, y, 1, 1, static_cast<float>(0.3 * std::pow(10.0, -2.0 * x / width)));
    fill(room, 20, 16, 2, 2, 500);
    return room;
}

// As a display of 0.04 to 130 cd/m2 shows both.
ErrorSummary displayed_difference(ImageF gpu, ImageD exact) {
    for (float& v : gpu.data) v = std::clamp(v, 0.04f, white);
    for (double& v : exact.data) v = std::clamp(v, 0.04, static_cast<double>(white));
    return summary(delta_e_itp(gpu, exact));
}

TEST(FraunhoferMask, DifferencesFromTheReferenceCannotBeSeen) {
    constexpr int width = 36, height = 40;
    constexpr double degree = 0.017453292519943295;
    const EyeGeometry g = rectilinear(width, height, 2 * std::atan(0.5 * width * degree / 13.85) / degree);
    const struct {
        const char* what;
        std::vector<std::string> settings;
        float open;
        bool unseen, unseen_when_fine;
    } apertures[] = {{"open eye", {}, 1, true, true},
                     {"half-closed eye", {}, 0.5625f, false, true},
                     {"diaphragm of six blades", {"glare.blades=6"}, 1, false, true},
                     {"cross-screen filter of two directions", {"glare.filter_directions=2"}, 1, false, false}};
    const ImageF room = dark_room(width, height);
    for (const auto& aperture : apertures) {
        const ImageD exact = reference(room, g, aperture.settings, 5, aperture.open);
        EXPECT_GT(exact.at(20, 14, 1) - static_cast<double>(room.at(20, 14, 1)), 0.3) << aperture.what << ": too little glare to be seen at all";
        ErrorSummary of[2];
        for (const bool fine : {false, true}) {
            const auto settings = fine ? with(aperture.settings, {"glare.texel_px=1", "glare.near_px=24"}) : aperture.settings;
            const ErrorSummary e = of[fine] = displayed_difference(Glare(g, model(settings)).at(room, 5, aperture.open), exact);
            const std::string setting = std::string(aperture.what) + (fine ? ", texel_px 1, near_px 24" : ", default");
            ledger(name, setting, "displayed p99 dE_ITP", e.p99);
            ledger(name, setting, "displayed mean dE_ITP", e.mean);
            if (fine ? aperture.unseen_when_fine : aperture.unseen) {
                EXPECT_LT(e.p99, 1) << setting;
                EXPECT_LT(e.mean, 0.2) << setting;
            }
        }
        EXPECT_LE(of[1].mean, of[0].mean * 1.1) << aperture.what;
    }
}

ImageF lamps(int size, int count, std::uint32_t seed = 3) {
    ImageF image = uniform(size, size, 1);
    std::mt19937 random(seed);
    for (int i = 0; i < count; ++i) {
        const int x = static_cast<int>(random() % static_cast<unsigned>(size)), y = static_cast<int>(random() % static_cast<unsigned>(size));
        fill(image, x, y, 1, 1, 1e6f, 7e5f, 3e5f);
    }
    return image;
}
TEST(FraunhoferMask, BillboardsAndTransformsDrawTheSame) {
    const EyeGeometry g = rectilinear(80, 80, 50);
    for (const int count : {1, 5, 12}) {
        const ImageF in = lamps(80, count);
        const ImageF drawn = Glare(g, model({"glare.billboard_texels=256", "glare.lid_open=0.6"})).at(in);
        const ImageF transformed = Glare(g, model({"glare.billboard_texels=0", "glare.lid_open=0.6"})).at(in);
        const ErrorSummary e = summary(relative_errors(drawn, transformed, 1));
        ledger(name, std::to_string(count) + " lamps", "billboards against transforms max relative", e.max);
        EXPECT_LT(e.max, 2e-3);
        EXPECT_LT(summary(code_errors(drawn, transformed)).max, 0.1);
        EXPECT_GT(e.max, 0) << "both took one way";
    }
    // More lamps than billboards: the transforms take over, to the bit.
    const ImageF many = lamps(80, 60);
    const ImageF a = Glare(g, model({"glare.billboard_texels=20"})).at(many), b = Glare(g, model({"glare.billboard_texels=0"})).at(many);
    EXPECT_EQ(0, std::memcmp(a.data.data(), b.data.data(), a.data.size() * sizeof(float)));
}

TEST(FraunhoferMask, StreaksStandAcrossTheEdges) {
    const EyeGeometry g = rectilinear(61, 61, 5);
    ImageF in = uniform(61, 61, 1);
    fill(in, 30, 30, 1, 1, 1e6f);
    const ImageF six = Glare(g, model(hexagon)).at(in);
    for (const double across : {30.0, 90.0, 150.0}) EXPECT_GT(in_wedge(six, in, 30, 30, across, 8, 6, 28), 3 * in_wedge(six, in, 30, 30, across + 30, 8, 6, 28)) << across;
    const ImageF turned = Glare(g, model(with(hexagon, {"glare.blade_rotation_deg=30"}))).at(in);
    EXPECT_GT(in_wedge(turned, in, 30, 30, 0, 8, 6, 28), 3 * in_wedge(turned, in, 30, 30, 30, 8, 6, 28));
    // Lashes stand upright: their streaks lie level, within the angle over which the lashes spread.
    const ImageF lashes = Glare(g, model()).at(in, 4, 0.55f);
    EXPECT_GT(in_wedge(lashes, in, 30, 30, 0, 20, 6, 28), 4 * in_wedge(lashes, in, 30, 30, 60, 20, 6, 28));
    const ImageF cross = Glare(g, model({"glare.filter_directions=2", "glare.filter_rotation_deg=0", "glare.lids=0", "glare.lashes=0"})).at(in);
    EXPECT_GT(in_wedge(cross, in, 30, 30, 90, 8, 6, 28), 4 * in_wedge(cross, in, 30, 30, 45, 8, 6, 28));
}

TEST(FraunhoferMask, ZonesShiftTheObstaclesNotThePupil) {
    const EyeGeometry g = rectilinear(64, 48, 80);
    ImageF in = uniform(64, 48, 1);
    fill(in, 10, 24, 1, 1, 1e6f);
    fill(in, 50, 24, 1, 1, 1e6f);
    const ImageF one = Glare(g, model(hexagon)).at(in), three = Glare(g, model(with(hexagon, {"glare.zones=3"}))).at(in);
    ledger(name, "3 zones of one diaphragm", "against one zone max relative", summary(relative_errors(three, one, 1)).max);
    EXPECT_LT(summary(relative_errors(three, one, 1)).max, 0.03);
    const ImageF lashes = Glare(g, model({"glare.lid_open=0.55"})).at(in), zones = Glare(g, model({"glare.lid_open=0.55", "glare.zones=3"})).at(in);
    EXPECT_GT(summary(relative_errors(zones, lashes, 1)).max, 0.05);
    // With the obstacle in the pupil's own plane the direction does not matter.
    const ImageF flat = Glare(g, model({"glare.lid_open=0.55", "glare.zones=3", "glare.obstacle_mm=0"})).at(in);
    EXPECT_LT(summary(relative_errors(flat, lashes, 1)).max, 0.1);
    // Light from the right meets what stands farther right: the aperture's picture moves to the left, by d tan(phi).
    EXPECT_NEAR(zone_angle_rad(2, 3), 0.7853981634, 1e-9);
    EXPECT_NEAR(zone_angle_rad(0, 3), -0.7853981634, 1e-9);
}

TEST(FraunhoferMask, WholeSceneKeepsUniformFieldsAndEnergy) {
    const EyeGeometry g = rectilinear(48, 40, 40);
    for (const char* zones : {"glare.zones=1", "glare.zones=2"}) {
        Glare glare(g, model({"glare.photographic=1", "glare.lid_open=0.55", zones}));
        const ImageF flat = uniform(48, 40, 1e4f, 5e3f, 1e3f);
        EXPECT_LT(summary(relative_errors(glare.at(flat), flat, 1e-6)).max, 1e-4);
        ImageF in = uniform(48, 40, 1);
        fill(in, 20, 18, 3, 3, 1e5f, 1e4f, 1e5f);
        const ImageF out = glare.at(in);
        double before = 0, after = 0;
        for (int y = 0; y < 40; ++y)
            for (int x = 0; x < 48; ++x) {
                const double sr = geometry::geometry_solid_angle(g, {x + 0.5, y + 0.5});
                before += sr * luminance(in, x, y), after += sr * luminance(out, x, y);
            }
        ledger(name, zones, "energy relative", std::abs(after / before - 1));
        EXPECT_NEAR(after / before, 1, 2e-3);
        EXPECT_LT(out.at(21, 19, 0), in.at(21, 19, 0)) << glare.outcome().why << glare.outcome().failed << out.at(20,25,1);
    }
}

TEST(FraunhoferMask, OnlyWhatThePanelCannotShowIsDiffracted) {
    const EyeGeometry g = rectilinear(48, 48, 30);
    std::mt19937 random(7);
    int ran = 0, gated = 0;
    Glare glare(g, model());
    for (int i = 0; i < 24; ++i) {
        // The brightest pixel within 20 % of the panel's white in every fourth scene.
        ImageF in = textured(48, 48, 1);
        for (float& v : in.data) v = std::min(v, white);
        const float peak = i % 4 == 0 ? white * (0.8f + 0.4f * static_cast<float>(random() % 1000) / 1000) : white * static_cast<float>(std::pow(10, static_cast<int>(random() % 7) - 3));
        fill(in, 20, 20, 2, 2, peak);
        const ImageF out = glare.at(in);
        const bool expected = peak > white;
        EXPECT_EQ(glare.outcome().gated, !expected);
        (expected ? ran : gated) += 1;
        if (!expected) {
            EXPECT_EQ(0, std::memcmp(in.data.data(), out.data.data(), in.data.size() * sizeof(float)));
        }
        for (std::size_t k = 0; k < in.data.size(); ++k) ASSERT_GE(out.data[k], in.data[k] * (1 - 1e-6f));
    }
    EXPECT_GT(ran, 5);
    EXPECT_GT(gated, 5);
}

TEST(FraunhoferMask, BrighterLampsNeverDarken) {
    const EyeGeometry g = rectilinear(48, 48, 30);
    ImageF in = uniform(48, 48, 1);
    fill(in, 20, 20, 2, 2, 1e4f);
    ImageF brighter = in;
    fill(brighter, 20, 20, 2, 2, 1e6f);
    Glare glare(g, model(hexagon));
    const ImageF a = glare.at(in), b = glare.at(brighter);
    for (std::size_t k = 0; k < a.data.size(); ++k) EXPECT_GE(b.data[k], a.data[k] * (1 - 1e-5f));
}

TEST(FraunhoferMask, NoStrengthNoChange) {
    const EyeGeometry g = rectilinear(32, 32, 30);
    const ImageF in = textured(32, 32, 10, 1e6);
    const ImageF out = Glare(g, model({"glare.strength=0"})).at(in), off = StageRunner({g}, only({})).run(in, still_input(1));
    EXPECT_EQ(0, std::memcmp(out.data.data(), off.data.data(), out.data.size() * sizeof(float)));
}

TEST(FraunhoferMask, HardPicturesAndEyes) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const auto& [w, h] : {std::pair{1, 1}, {7, 3}, {33, 1}}) {
        ImageF in = uniform(w, h, 1);
        fill(in, w / 2, h / 2, 1, 1, inf, nan, -1e8f);
        for (const char* whole : {"glare.photographic=0", "glare.photographic=1"}) {
            Glare glare(rectilinear(w, h, 20), model({whole}));
            EXPECT_TRUE(all_finite(glare.at(in)));
            EXPECT_EQ(glare.outcome().failed, "");
        }
    }
    // A closed eye has no aperture: nothing is diffracted. Pupils and lids that are no numbers: 4 mm, open.
    const EyeGeometry g = rectilinear(32, 32, 20);
    const ImageF in = lamps(32, 1);
    Glare glare(g, model());
    const ImageF closed = glare.at(in, 4, 0);
    EXPECT_EQ(0, std::memcmp(in.data.data(), closed.data.data(), in.data.size() * sizeof(float)));
    const ImageF strange = glare.at(in, nan, nan), usual = glare.at(in, 4, 1);
    EXPECT_EQ(0, std::memcmp(strange.data.data(), usual.data.data(), in.data.size() * sizeof(float)));
}

TEST(FraunhoferMask, BlinksFadeAlikeAtAnyFrameRate) {
    const EyeGeometry g = rectilinear(32, 32, 20);
    const ImageF in = lamps(32, 1);
    const auto half_way = [&](int frames) {
        Glare glare(g, model());
        glare.at(in, 4, 1);
        glare.at(in, 4, 0.5f, false, 0);             // asks for the new aperture
        ImageF out;
        for (int i = 0; i < frames; ++i) out = glare.at(in, 4, 0.5f, false, 0.025 / frames);
        return out;
    };
    const ImageF slow = half_way(1), fast = half_way(5);
    EXPECT_LT(summary(relative_errors(fast, slow, 1)).max, 1e-4);
    Glare glare(g, model());
    const ImageF open = glare.at(in, 4, 1);
    ImageF out;
    for (int i = 0; i < 8; ++i) out = glare.at(in, 4, 0.5f, false, 0.02);
    const ImageF fresh = Glare(g, model()).at(in, 4, 0.5f);
    EXPECT_EQ(0, std::memcmp(out.data.data(), fresh.data.data(), out.data.size() * sizeof(float)));
    EXPECT_GT(summary(relative_errors(slow, open, 1)).max, 0.01);
    EXPECT_GT(summary(relative_errors(slow, fresh, 1)).max, 0.01);
}

TEST(FraunhoferMask, TablesAreMadeAside) {
    MaskTableMaker maker;
    FraunhoferMaskParams p{};
    const std::vector<float> values = default_parameters(*find_model("glare", "fraunhofer_mask"));
    std::memcpy(&p, values.data(), sizeof p);
    maker.configure(p, nullptr);
    EXPECT_EQ(maker.tables({16, 16}, false), nullptr);
    const auto made = maker.tables({16, 16}, true);
    ASSERT_NE(made, nullptr);
    EXPECT_EQ(maker.tables({16, 16}, false), made) << "kept";
    maker.configure(p, nullptr);
    EXPECT_EQ(maker.tables({16, 16}, false), nullptr) << "forgotten";
}

TEST(FraunhoferMask, SigmoidLaysTheVeilOver) {
    const EyeGeometry g = rectilinear(32, 32, 20);
    const ImageF in = lamps(32, 1);
    const ImageF plain = Glare(g, model()).at(in), curved = Glare(g, model({"glare.sigmoid=1"})).at(in);
    const auto curve = [](double v) { return 640 * (std::pow(v, 0.465) + 0.05) / (std::pow(v, 0.465) + 20); };
    for (std::size_t k = 0; k < in.data.size(); ++k) {
        const double veil = static_cast<double>(plain.data[k]) - static_cast<double>(in.data[k]);
        if (in.data[k] > 100 || veil < 0.01) continue;       // a lamp's own rounding
        EXPECT_NEAR((static_cast<double>(curved.data[k]) - static_cast<double>(in.data[k])) / ((curve(veil) - 1.6) * 130 / 255), 1, 2e-3);
    }
    const Selection paper = value(select("kakimoto2004"));
    ASSERT_EQ(paper.choices.size(), 1u);
    EXPECT_EQ(paper.choices[0].entry->name, "fraunhofer_mask");
}

TEST(FraunhoferMask, AnyPictureIsAMask) {
    const auto folder = std::filesystem::temp_directory_path() / "entoptic_fraunhofer_mask_test";
    std::filesystem::create_directories(folder);
    // A slit, upright, as alpha of a white picture: its streak lies level.
    Image8 slit(200, 100, 4);
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 200; ++x)
            for (int c = 0; c < 4; ++c) slit.at(x, y, c) = c < 3 || std::abs(x - 100) < 3 ? 255 : 0;
    const std::string path = folder / "slit.png", text = folder / "notes.txt", gone = folder / "gone.png";
    check(write_png(path, slit));
    std::ofstream(text) << "not a picture";
    std::filesystem::remove(gone);
    const auto picture = value(read_mask_picture(path));
    EXPECT_NEAR(picture->transmission.at(100, 50, 0), 1, 1e-9);
    EXPECT_EQ(picture->transmission.at(10, 50, 0), 0);

    const EyeGeometry g = rectilinear(61, 61, 5);
    ImageF in = uniform(61, 61, 1);
    fill(in, 30, 30, 1, 1, 1e6f);
    const std::vector<std::string> settings = {"glare.lids=0", "glare.lashes=0", "glare.mask=" + path};
    StageRunner runner({g}, model(settings));
    const ImageF out = runner.run(in, still_input(1));
    EXPECT_GT(in_wedge(out, in, 30, 30, 0, 10, 6, 28), 8 * in_wedge(out, in, 30, 30, 90, 10, 6, 28));

    // Errors name key and file; what was chosen before stays.
    const auto error = [](const std::string& setting) {
        const auto chosen = select("off", {"glare=fraunhofer_mask"}, {setting});
        return chosen ? std::string() : chosen.error().message;
    };
    for (const std::string& wrong : {text, gone}) {
        EXPECT_NE(error("glare.mask=" + wrong).find("glare.mask"), std::string::npos);
        EXPECT_NE(error("glare.mask=" + wrong).find(wrong), std::string::npos);
    }
    const std::string black = folder / "black.png", amplifier = folder / "amplifier.exr", broken = folder / "nan.exr";
    check(write_png(black, Image8(8, 8, 1)));
    check(write_exr(amplifier, ImageF(8, 8, 3, 1.5f), {}));
    check(write_exr(broken, ImageF(8, 8, 3, std::numeric_limits<float>::quiet_NaN()), {}));
    EXPECT_NE(error("glare.mask=" + black).find("no light"), std::string::npos);
    EXPECT_NE(error("glare.mask=" + amplifier).find("0 (opaque) to 1 (clear)"), std::string::npos);
    EXPECT_NE(error("glare.mask=" + broken).find("0 (opaque) to 1 (clear)"), std::string::npos);
    EXPECT_NE(error("glare.nothing=1").find("mask"), std::string::npos) << "the list of parameters names the file";
    EXPECT_EQ(error("glare.mask="), "");
    Selection other = model(settings);
    other.choices[0].files["mask"] = gone;
    other.choices[0].parameters[0] = 5;
    EXPECT_FALSE(runner.stage().select(other));
    const ImageF again = runner.run(in, still_input(1));
    EXPECT_EQ(0, std::memcmp(out.data.data(), again.data.data(), out.data.size() * sizeof(float)));
    std::filesystem::remove_all(folder);
}

TEST(FraunhoferMask, SameEyeSamePicture) {
    const EyeGeometry g = rectilinear(32, 32, 20);
    const ImageF in = lamps(32, 3);
    Glare a(g, model()), b(g, model());
    const ImageF first = a.at(in, 3.3f, 0.6f);
    b.at(in, 6, 0.9f);
    const ImageF second = b.at(in, 3.3f, 0.6f);
    EXPECT_EQ(0, std::memcmp(first.data.data(), second.data.data(), first.data.size() * sizeof(float)));
}

TEST(FraunhoferMask, GateIsExactOnBothSides) { expect_exact_gate(model()); }

}  // namespace
}  // namespace entoptic::perception
