// labels: gpu
// fraunhofer_mask on the GPU: against its reference, laws, billboards against transforms, zones, files, gate, states.
#include "base/image_io.h"
#include "perception/glare/fraunhofer_mask_tables.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"

#include <cstring>
#include <filesystem>
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
[[maybe_unused]] double in_wedge(const ImageF& out, const ImageF& in, int cx, int cy, double azimuth_deg, double half_deg, double inner, double outer) {
    double sum = 0;
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) {
            const double r = std::hypot(x - cx, y - cy), a = std::atan2(cy - y, x - cx) * 180 / 3.14159265358979 - azimuth_deg;
            if (r > inner && r < outer && std::abs(std::remainder(a, 180.0)) < half_deg) sum += luminance(out, x, y) - luminance(in, x, y);
        }
    return sum;
}

struct Scene {
    const char* what;
    ImageF image;
    std::vector<std::string> settings;
    float open;
};

TEST(FraunhoferMask, GpuAndReferenceAgree) {
    const EyeGeometry g = rectilinear(25, 21, 2.0);      // 12.5 pixels a degree
    ImageF lamp = uniform(25, 21, 1);
    fill(lamp, 12, 10, 1, 1, 1e6f);
    ImageF coloured = uniform(25, 21, 1);
    fill(coloured, 12, 10, 1, 1, 1e6f, 4e5f, 1e5f);
    const Scene list[] = {
        {"round pupil", lamp, {"glare.texel_px=1"}, 1},
        {"lashes half closed", lamp, {"glare.texel_px=1"}, 0.55f},
        {"hexagon three lines", coloured, {"glare.texel_px=1", "glare.blades=6", "glare.lids=0", "glare.lashes=0", "glare.three_lines=1"}, 1},
        {"cross-screen filter", lamp, {"glare.texel_px=1", "glare.filter_directions=2", "glare.lids=0", "glare.lashes=0"}, 1},
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
        EXPECT_LT(e.mean, 0.15) << s.what;
        EXPECT_NEAR(got / want, 1, 0.1) << s.what;
        if (std::getenv("ENTOPTIC_MASK_PRINT"))
            for (int y = 4; y < 17; ++y) {
                for (int x = 4; x < 21; ++x) std::printf("%8.1f/%-8.1f", static_cast<double>(gpu.at(x, y, 1)), exact.at(x, y, 1));
                std::printf("\n");
            }
    }
}

}  // namespace
}  // namespace entoptic::perception
