// labels: gpu
#include "perception/glare/closed_form_math.glsl"
#include "perception/glare/closed_form_params.h"
#include "perception/glare/glare_gate_law.h"
#include "perception/glare/glare_testing.h"

#include <cstring>
#include <limits>
#include <random>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const char* const name = "glare.closed_form";
// Without a tone model the panel's white is the scene's.
constexpr float white = 130;

using Settings = std::vector<std::string>;
Settings with(Settings settings, const Settings& more) {
    settings.insert(settings.end(), more.begin(), more.end());
    return settings;
}
Selection model(const Settings& settings = {}) { return only({"glare=closed_form"}, settings); }
bool same(const ImageF& a, const ImageF& b) { return std::memcmp(a.data.data(), b.data.data(), a.data.size() * sizeof(float)) == 0; }

ImageD reference(const ImageF& picture, const EyeGeometry& g, const Settings& settings, float pupil_mm = 4) {
    ReferenceFrame frame{convert<double>(picture), g, {}, {}, 0, false, 1, 1};
    frame.eye.pupil_diameter_mm = pupil_mm;
    static const std::unique_ptr<ReferenceModel> reference_model = find_model("glare", "closed_form")->create_reference();
    reference_model->apply(frame, model(settings).choices[0].parameters);
    return frame.image;
}
// What the panel sends of scene light when its white is the scene's.
template <class T> ImageD shown(const Image<T>& light) {
    ImageD out = convert<double>(light);
    for (double& v : out.data) v = std::clamp(v, 0.04, static_cast<double>(white));
    return out;
}

// --- the formulas ---

TEST(ClosedForm, StraylightIsThatOfTheTable) {
    double worst = 0, worst_age = 0;
    for (const OracleRow& row : oracle("cie_glare"))
        if (row.at("theta_deg") <= 100)
            worst = std::max(worst, relative_error(closed_form::cie146(row.at("theta_deg"), row.at("age_years"), row.at("pigment_p")), row.at("CIE146_general_per_sr")));
    // The straylight parameter of an eye is theta^2 L/E at 7 degrees.
    for (const OracleRow& row : oracle("straylight_age"))
        worst_age = std::max(worst_age, relative_error(49 * closed_form::cie146(7, row.at("age"), 0.5), row.at("CIE146_theta2_times_L_over_E_at_7deg_p0.5")));
    ledger(name, "CIE 146", "double against oracle max", worst);
    EXPECT_LT(worst, 1e-7);
    EXPECT_LT(worst_age, 1e-7);
    EXPECT_NEAR(closed_form::straylight(7, 30, 0.5, 3) / closed_form::cie146(7, 30, 0.5), 3, 1e-9) << "a cataract is measured at 7 degrees";
}

TEST(ClosedForm, RingOfTheLensHasEnergyOne) {
    for (const double nm : {450.0, 568.0, 650.0}) {
        double sum = 0;
        for (double deg = 0.0005; deg < 8; deg += 0.001) sum += closed_form::lenticular_ring(deg, nm) * 2 * pi * std::sin(deg * degree) * 0.001 * degree;
        EXPECT_NEAR(sum, 1, 0.03) << nm;      // Spencer's figures are rounded
    }
    EXPECT_EQ(closed_form::lenticular_share(1.9), 0);
    EXPECT_NEAR(closed_form::lenticular_share(6), 0.033, 1e-12);
}

// Veil of a lamp over its illuminance. Beyond a degree all that is scattered is what the CIE says, in luminance; and without straylight it
// is the closed form of the table.
TEST(ClosedForm, VeilOfALampIsThatOfTheTables) {
    const EyeGeometry g = rectilinear(181, 181, 30);
    ImageF in = uniform(181, 181, 0);
    fill(in, 90, 90, 1, 1, 1e6f);
    const Settings plain = {"glare.rescatter=0"};
    double worst = 0, worst_luminance = 0;
    for (const int age : {20, 80}) {
        const ImageF out = Glare(g, model(with(plain, {"glare.pigment=1", "glare.particles_per_mm2=0", "glare.diffraction=0", "glare.age=" + std::to_string(age)}))).at(in);
        for (const OracleRow& row : oracle("cie_glare")) {
            if (row.at("age_years") != age || row.at("pigment_p") != 1 || row.at("theta_deg") > 14 || row.at("theta_deg") < 1) continue;
            const Ring ring = ring_around(out, g, 90, 90, 1e6 - static_cast<double>(white), row.at("theta_deg"));
            const double y = 0.2126 * ring.mean[0] + 0.7152 * ring.mean[1] + 0.0722 * ring.mean[2];
            const double error = relative_error(y, row.at("CIE146_general_per_sr"));
            worst_luminance = std::max(worst_luminance, error);
        }
    }
    ledger(name, "lamp, ages 20 and 80, 1 to 14 degrees", "GPU veil against CIE 146 max", worst_luminance);
    // 6 pixels a degree: near field and grid meet at 8 pixels, where a lamp of one pixel shows the grid.
    EXPECT_LT(worst_luminance, 0.10);
    // The table is for a pupil of 4 mm and 1000 particles of 6 um.
    const ImageF a = Glare(g, model(with(plain, {"glare.straylight_factor=1"}))).at(in);
    const ImageF b = Glare(g, model(with(plain, {"glare.straylight_factor=1", "glare.particles_per_mm2=0", "glare.diffraction=0"}))).at(in);
    for (const OracleRow& row : oracle("halo_radial_rgb")) {
        if (row.at("pupil_mm") != 4 || row.at("particle_um") != 6 || row.at("count") != 1000 || row.at("theta_deg") > 10 || row.at("theta_deg") < 1) continue;
        const double deg = row.at("theta_deg"), expected[3] = {row.at("R_per_sr"), row.at("G_per_sr"), row.at("B_per_sr")};
        const Ring all = ring_around(a, g, 90, 90, 1e6 - static_cast<double>(white), deg), straylight = ring_around(b, g, 90, 90, 1e6 - static_cast<double>(white), deg);
        // The same light is missing from the straylight at all angles.
        for (int c = 0; c < 3; ++c) {
            const double made_room = straylight.mean[c] - (all.mean[c] - expected[c]);
            EXPECT_GT(made_room, -0.1 * straylight.mean[c]) << deg;
            worst = std::max(worst, std::abs(made_room / straylight.mean[c]));
        }
    }
    ledger(name, "lamp, default", "straylight that gives way to particles and pupil max", worst);
    EXPECT_LT(worst, 0.2);
}

// --- the law ---

// A lamp above the panel's white in a room below it.
ImageF room(int width, int height, float lamp, int size = 3) {
    ImageF in = textured(width, height, 1);
    for (float& v : in.data) v = std::min(v, white);
    fill(in, width / 2, height / 2, size, size, lamp, 0.6f * lamp, 0.3f * lamp);
    return in;
}

TEST(ClosedForm, WithinThePanelsWhiteNothingChanges) {
    const EyeGeometry g = wide();
    Glare glare(g, model());
    ImageF in = room(180, 200, white);
    EXPECT_TRUE(same(in, glare.at(in)));
    EXPECT_TRUE(glare.outcome().gated);
    EXPECT_EQ(glare.outcome().bound_codes, 0);
    // A hair above it runs, and changes next to nothing.
    in.at(90, 100, 0) = std::nextafter(white, 200.0f) * 1.0001f;
    const ImageF out = glare.at(in);
    EXPECT_FALSE(glare.outcome().gated);
    EXPECT_LT(summary(relative_errors(out, in, 1)).max, 1e-3);
}

TEST(ClosedForm, GateIsExactOnBothSides) { expect_exact_gate(model()); }

TEST(ClosedForm, GrowsFromNothingWithoutAStep) {
    const EyeGeometry g = rectilinear(64, 64, 10);
    Glare glare(g, model());
    double before = 0, worst = 0;
    for (int i = 0; i <= 20; ++i) {
        const float lamp = white * (0.9f + 0.02f * static_cast<float>(i));
        const ImageF in = room(64, 64, lamp), out = glare.at(in);
        const double added = static_cast<double>(out.at(36, 32, 0) - in.at(36, 32, 0));
        worst = std::max(worst, std::abs(added - before));
        before = added;
    }
    ledger(name, "lamp 117 to 169 in 20 steps", "largest step of the halo, cd/m2", worst);
    EXPECT_LT(worst, 0.1);
    EXPECT_GT(before, 0.01);
}

TEST(ClosedForm, StrengthZeroIsNotRecorded) {
    Glare glare(native(), model({"glare.strength=0"}));
    const ImageF in = room(96, 80, 1e5f);
    EXPECT_TRUE(same(in, glare.at(in)));
    EXPECT_FALSE(glare.outcome().recorded);
}

TEST(ClosedForm, PhotographicKeepsUniformFieldsAndEnergy) {
    const EyeGeometry g = wide();
    Glare glare(g, model({"glare.photographic=1", "glare.near_from=0"}));
    const ImageF flat = uniform(180, 200, 700, 90, 3);
    double worst = 0;
    const ImageF of_flat = glare.at(flat);
    for (std::size_t i = 0; i < flat.data.size(); ++i) worst = std::max(worst, relative_error(static_cast<double>(of_flat.data[i]), static_cast<double>(flat.data[i])));
    ledger(name, "photographic, uniform field", "relative change max", worst);
    EXPECT_LT(worst, 1e-5);
    const ImageF in = room(180, 200, 1e5f), out = glare.at(in);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(energy(out, g, c) / energy(in, g, c), 1, 5e-4);
}

TEST(ClosedForm, BrighterLampLowersNoPixel) {
    const EyeGeometry g = wide();
    Glare glare(g, model({"glare.rescatter=0"}));
    const ImageF of_dim = glare.at(room(180, 200, 1e4f)), of_bright = glare.at(room(180, 200, 2e4f));
    double lowest = 0;
    for (std::size_t i = 0; i < of_dim.data.size(); ++i)
        lowest = std::min(lowest, static_cast<double>(of_bright.data[i] - of_dim.data[i]) / static_cast<double>(of_dim.data[i]));
    EXPECT_GT(lowest, -2e-6);
}

// The law itself: what reaches the wearer's retina from the panel is what would reach it from the scene, where the panel can do it.
TEST(ClosedForm, TheWearerSeesTheScenesVeil) {
    const EyeGeometry g = rectilinear(64, 64, 27);
    ImageF in = uniform(64, 64, 1);
    fill(in, 28, 28, 8, 8, 3000);
    const Settings eye = {"glare.photographic=1", "glare.near_from=0"};
    const ImageD wanted = reference(in, g, eye);
    const auto seen_at_panel = [&](const Settings& settings) { return reference(convert<float>(shown(Glare(g, model(settings)).at(in))), g, eye); };
    const auto veil_error = [&](const ImageD& seen) {
        double sum = 0;
        int count = 0;
        for (int x = 42; x < 60; x += 2) sum += (seen.at(x, 32, 1) - wanted.at(x, 32, 1)) / (wanted.at(x, 32, 1) - 1), ++count;
        return sum / count;
    };
    const double law = veil_error(seen_at_panel({})), doubled = veil_error(seen_at_panel({"glare.rescatter=0"})), none = veil_error(convert<double>(reference(convert<float>(shown(in)), g, eye)));
    ledger(name, "lamp of 3.3 degrees, 3000 cd/m2", "mean error of the veil on the wearer's retina", law);
    ledger(name, "lamp of 3.3 degrees, 3000 cd/m2, rescatter 0", "mean error of the veil on the wearer's retina", doubled);
    ledger(name, "lamp of 3.3 degrees, 3000 cd/m2, no model", "mean error of the veil on the wearer's retina", none);
    EXPECT_LT(std::abs(law), 0.08);
    EXPECT_GT(doubled, law);
    EXPECT_LT(none, -0.8);
}

TEST(ClosedForm, AnOlderPersonSeesMoreVeilOfThePanelItself) {
    const EyeGeometry g = wide();
    ImageF in = uniform(180, 200, 1);
    fill(in, 60, 60, 40, 40, white);
    Glare same_eye(g, model({"glare.age=70"})), older(g, model({"glare.age=70", "glare.wearer_age=30"})), younger(g, model({"glare.age=30", "glare.wearer_age=70"}));
    EXPECT_TRUE(same(in, same_eye.at(in))) << "the wearer's own eye does it";
    const ImageF more = older.at(in), less = younger.at(in);
    EXPECT_GT(more.at(110, 80, 1), 1.05f);
    EXPECT_LT(less.at(110, 80, 1), 0.95f);
    EXPECT_TRUE(all_finite(less));
    const ImageF flat = uniform(180, 200, 50);
    EXPECT_LT(summary(relative_errors(older.at(flat), flat, 1e-3)).max, 1e-5);
}

// --- three comparisons ---

struct Scene { std::string what; EyeGeometry g; ImageF image; Settings settings; double p99 = 1, mean = 0.2; };
std::vector<Scene> scenes() {
    std::vector<Scene> list;
    const EyeGeometry axis = rectilinear(64, 52, 6.7);
    list.push_back({"lamp 1e4, 9.6 ppd", axis, room(64, 52, 1e4f), {}});
    list.push_back({"lamp 1e4, 9.6 ppd, white straylight, light eyes", axis, room(64, 52, 1e4f), {"glare.straylight_colour=0", "glare.pigment=1.2"}});
    ImageF window = uniform(64, 52, 1);
    fill(window, 20, 20, 24, 20, 60, 90, 120);
    list.push_back({"cataract beside a normal wearer, window within the panel's white", axis, window, {"glare.straylight_factor=4", "glare.wearer_straylight_factor=1"}, 12, 1.5});
    list.push_back({"window 2e3, 100 degrees", rectilinear(64, 68, 100), room(64, 68, 2e3f, 6), {}, 6, 0.3});
    list.push_back({"photographic, 9.6 ppd", axis, room(64, 52, 1e4f), {"glare.photographic=1", "glare.near_from=0"}});
    const struct { const char* what; float rgb[3]; } lamps[] = {{"red", {1, 0, 0}}, {"green", {0, 1, 0}}, {"blue", {0, 0, 1}}};
    for (const auto& lamp : lamps) {
        ImageF night = uniform(64, 52, 1);
        fill(night, 30, 25, 3, 3, 1e4f * lamp.rgb[0], 1e4f * lamp.rgb[1], 1e4f * lamp.rgb[2]);
        list.push_back({std::string(lamp.what) + " lamp 1e4 by its own spectrum, light eyes", axis, night, {"glare.emission_spectra=1", "glare.pigment=0.2"}});
    }
    return list;
}

TEST(ClosedForm, GpuAgreesWithTheReference) {
    for (const Scene& scene : scenes()) {
        const ImageF gpu = Glare(scene.g, model(scene.settings)).at(scene.image, 3.7f);
        const ImageD exact = reference(scene.image, scene.g, scene.settings, 3.7f);
        const ErrorSummary light = summary(relative_errors(gpu, exact, 1e-3)), display = summary(delta_e_itp(shown(gpu), shown(exact)));
        ledger(name, scene.what, "GPU against reference p99", light.p99);
        ledger(name, scene.what, "GPU against reference mean", light.mean);
        ledger(name, scene.what, "GPU against reference p99 dE_ITP", display.p99);
        ledger(name, scene.what, "GPU against reference mean dE_ITP", display.mean);
        EXPECT_LT(light.mean, 0.05) << scene.what;
        // Elsewhere it cannot be seen. The displayed light has no near field: within two pixels of an edge a cataract's own haze is missing. Of 100 degrees in 64
        // pixels the near field is narrower than the grid can carry.
        EXPECT_LT(display.p99, scene.p99) << scene.what;
        EXPECT_LT(display.mean, scene.mean) << scene.what;
    }
}

TEST(ClosedForm, ColouredLampsScatterByTheirOwnSpectrum) {
    const EyeGeometry g = rectilinear(64, 64, 20);
    Glare of_white(g, model({"glare.near_px=0"})), of_own(g, model({"glare.near_px=0", "glare.emission_spectra=1"}));
    const struct { const char* what; float rgb[3]; } lamps[] = {{"white", {1, 1, 1}}, {"red", {1, 0, 0}}, {"green", {0, 1, 0}}, {"blue", {0, 0, 1}}};
    for (const auto& lamp : lamps) {
        ImageF in = uniform(64, 64, 1);
        fill(in, 31, 31, 2, 2, 1e6f * lamp.rgb[0] + 1, 1e6f * lamp.rgb[1] + 1, 1e6f * lamp.rgb[2] + 1);
        const ImageF plain = of_white.at(in), own = of_own.at(in);
        EXPECT_TRUE(all_finite(own));
        const ErrorSummary error = summary(delta_e_itp(shown(plain), shown(own)));
        ledger(name, std::string("lamp 1e6, ") + lamp.what, "one spectrum for all against own p99 dE_ITP", error.p99);
        if (lamp.rgb[0] == 1 && lamp.rgb[1] == 1) {
            EXPECT_LT(error.p99, 1.7) << "white light is white either way";
        }
    }
}

// --- hard cases ---

TEST(ClosedForm, HardScenesStayFinite) {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    EyeGeometry sphere{};
    sphere.kind = geometry_equirect;
    sphere.width = 128;
    sphere.height = 64;
    for (const EyeGeometry& g : {rectilinear(101, 37, 100), vive_lens(144, 160), sphere, rectilinear(1, 1, 10), rectilinear(3, 2, 60)}) {
        const int w = static_cast<int>(g.width), h = static_cast<int>(g.height);
        Glare glare(g, model({"glare.wearer_age=60", "glare.lenticular_halo=1", "glare.emission_spectra=1"}));
        ImageF sun = uniform(w, h, 1e-3f);
        fill(sun, w / 2, h / 2, 1, 1, 1e8f);
        if (w > 20) fill(sun, 5, 5, 3, 1, nan, inf, -3);
        for (const float pupil : {4.0f, nan}) {
            const ImageF out = glare.at(sun, pupil);
            EXPECT_TRUE(all_finite(out)) << w;
            for (const float v : out.data) EXPECT_GE(v, 0.0f);
        }
    }
}

TEST(ClosedForm, MovingPupilDoesNotFlash) {
    const EyeGeometry g = rectilinear(64, 64, 40);
    Glare glare(g, model());
    const ImageF in = room(64, 64, 1e5f);
    double worst = 0;
    for (const double start : {1.9, 7.5}) {
        ImageF before;
        for (int i = 0; i < 25; ++i) {
            const ImageF now = glare.at(in, static_cast<float>(start + 0.01 * i));
            for (std::size_t k = 0; k < now.data.size() && !before.data.empty(); ++k)
                worst = std::max(worst, relative_error(static_cast<double>(now.data[k]), static_cast<double>(before.data[k])));
            before = now;
        }
    }
    ledger(name, "pupil 1.9..7.8 mm in steps of 0.01 mm", "frame to frame change max", worst);
    EXPECT_LT(worst, 0.01);
}

}  // namespace
}  // namespace entoptic::perception
