// For tests: what every adaptation model keeps true (adaptation.h), as functions that take the model's name. Header-only.
#pragma once

#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"

#include <limits>

namespace entoptic::perception::testing {

struct AdaptationLaws {
    std::string model;
    std::vector<std::string> settings;

    Selection selection() const { return only({"adaptation=" + model}, settings); }
    std::vector<float> parameters() const { return selection().find("adaptation")->parameters; }
    static ViewOutcome seen(StageRunner& runner, const ImageF& picture, const FrameInput& input) {
        runner.run(picture, input);
        return runner.stage().view(0);
    }
    // A after `seconds` of `y` in `frames` frames, from `before`.
    double after(double before, float y, double seconds, int frames) const {
        StageRunner runner({rectilinear(16, 8, 60)}, selection());
        runner.stage().set_adaptation(static_cast<float>(before));
        const ImageF picture = uniform(16, 8, y);
        ViewOutcome view;
        for (int i = 0; i < frames; ++i) view = seen(runner, picture, still_input(1, seconds / frames, false));
        return static_cast<double>(view.adaptation_cd_m2);
    }
    // The same by the reference, in one frame or many.
    double reference(double before, float y, double seconds, int frames = 1) const {
        const auto reference = find_model("adaptation", model)->create_reference();
        ReferenceFrame frame{convert<double>(uniform(16, 8, y)), rectilinear(16, 8, 60), {}, {}, seconds / frames, false, before, 1};
        for (int i = 0; i < frames; ++i) reference->apply(frame, parameters());
        return frame.adaptation_cd_m2;
    }

    void constant_light_is_adapted_to() const {
        StageRunner runner({vive_lens(180, 200)}, selection());
        for (float y : {1e-6f, 1e-3f, 1.0f, 1e4f, 1e8f})
            EXPECT_LT(relative_error(static_cast<double>(seen(runner, uniform(180, 200, y), still_input(1)).adaptation_cd_m2), static_cast<double>(y)), 3e-6) << y;
    }
    void frame_rate_does_not_matter(double tolerance = 1e-4) const {
        for (const auto& [before, y] : {std::pair{100.0, 0.01f}, std::pair{0.01, 1000.0f}}) {
            const double whole = reference(before, y, 1);
            for (int fps : {45, 90, 144, 1000}) {
                const double error = relative_error(after(before, y, 1, fps), whole);
                ledger(("adaptation." + model).c_str(), std::to_string(fps) + " fps for 1 s" + (y < 1 ? " into the dark" : " into light"), "float against reference rel", error);
                EXPECT_LT(error, tolerance) << fps << " from " << before;
            }
        }
    }
    void gpu_is_the_reference_over_times(double tolerance = 2e-5) const {
        double worst = 0;
        for (double before : {1e-6, 1e-3, 1.0, 1e4, 1e8})
            for (float y : {1e-6f, 0.04f, 30.0f, 1e8f})
                for (double dt : {1e-4, 1.0 / 90, 0.3, 5.0, 1000.0})
                    worst = std::max(worst, relative_error(after(before, y, dt, 1), reference(before, y, dt)));
        ledger(("adaptation." + model).c_str(), "steps 1e-4 to 1000 s", "float against reference max rel", worst);
        EXPECT_LT(worst, tolerance);
    }
    void time_that_does_not_pass_moves_nothing() const {
        StageRunner runner({rectilinear(64, 64, 60)}, selection());
        seen(runner, uniform(64, 64, 100), still_input(1));
        for (double dt : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()})
            EXPECT_NEAR(static_cast<double>(seen(runner, uniform(64, 64, 1), still_input(1, dt, false)).adaptation_cd_m2), 100, 1e-4);
    }
    void blink_holds_the_state() const {
        StageRunner runner({rectilinear(64, 64, 60)}, selection());
        seen(runner, uniform(64, 64, 10), still_input(1));
        FrameInput closed = still_input(1, 1.0 / 90, false);
        closed.eyes[0].eyelid_open = 0;
        for (int i = 0; i < 30; ++i) EXPECT_NEAR(static_cast<double>(seen(runner, uniform(64, 64, 0), closed).adaptation_cd_m2), 10, 1e-5);
    }
    void picture_is_not_touched() const {
        StageRunner runner({rectilinear(320, 256, 60)}, selection()), off({rectilinear(320, 256, 60)}, only({}));
        const ImageF picture = textured(320, 256, 1, 1e6);
        EXPECT_EQ(runner.run(picture, still_input(1)).data, off.run(picture, still_input(1)).data);
    }
    // The target of a structured scene, against the pixel-by-pixel reference.
    void target_is_that_of_the_pixels() const {
        for (double lamp : {0.0, 1e5}) {
            const EyeGeometry g = rectilinear(720, 400, 45);
            ImageF picture(720, 400, 3);
            for (int y = 0; y < 400; ++y)
                for (int x = 0; x < 720; ++x)
                    for (int c = 0; c < 3; ++c) {
                        picture.at(x, y, c) = static_cast<float>(std::exp(2 * std::sin(x * 0.008) + std::cos(y * 0.01)));
                        if (std::abs(x - 600) < 32 && std::abs(y - 100) < 16) picture.at(x, y, c) += static_cast<float>(lamp);
                    }
            StageRunner runner({g}, selection());
            const double gpu = static_cast<double>(seen(runner, picture, still_input(1)).target_cd_m2);
            ReferenceFrame frame{convert<double>(picture), g, {}, {}, 0, true, 0, 1};
            find_model("adaptation", model)->create_reference()->apply(frame, parameters());
            const double error = relative_error(gpu, frame.adaptation_cd_m2);
            ledger(("adaptation." + model).c_str(), lamp > 0 ? "smooth picture with lamp 16 ppd" : "smooth picture 16 ppd", "float against reference rel", error);
            EXPECT_LT(error, lamp > 0 ? 0.05 : 0.02) << lamp;     // a lamp counts from the middles of its tiles
        }
    }
    void hard_cases_stay_finite() const {
        for (const auto& [width, height] : {std::pair{1, 1}, std::pair{1011, 277}, std::pair{33, 9}}) {
            StageRunner runner({rectilinear(width, height, 100)}, selection());
            for (float y : {0.0f, 1e-6f, 1e8f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
                for (bool snap : {true, false})
                    for (double dt : {0.01, 1e9}) {
                        const ViewOutcome view = seen(runner, uniform(width, height, y), still_input(1, dt, snap));
                        EXPECT_TRUE(std::isfinite(view.adaptation_cd_m2)) << width << " " << y;
                        EXPECT_GE(view.adaptation_cd_m2, 0.999e-6f);
                        EXPECT_LE(view.adaptation_cd_m2, 1.001e8f);
                    }
        }
    }
};

}  // namespace entoptic::perception::testing
