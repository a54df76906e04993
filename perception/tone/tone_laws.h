// For tests: what every tone map keeps true (tone.h), as functions that take the model's name. Header-only.
#pragma once

#include "perception/observer_state.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"

#include <limits>

namespace entoptic::perception::testing {

// Neutral ramp over the whole range of scenes.
inline ImageF luminance_ramp(int width) {
    ImageF image(width, 1, 3);
    for (int x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c) image.at(x, 0, c) = static_cast<float>(std::pow(10, -6 + 14.0 * x / (width - 1)));
    return image;
}
// Saturated and mixed colours over the whole range.
inline ImageF colour_ramps(int width) {
    const float mixes[8][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}, {1, 0.9f, 0.4f}, {0.2f, 0.3f, 1}};
    ImageF image(width, 8, 3);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = mixes[y][c] * static_cast<float>(std::pow(10, -6 + 14.0 * x / (width - 1)));
    return image;
}

class ToneLaws {
public:
    ToneLaws(std::string model, std::vector<std::string> settings = {}) : model_(std::move(model)), settings_(std::move(settings)) {}

    Selection selection() const { return only({"tone=" + model_}, settings_); }
    std::string name() const { return "tone." + model_; }

    ImageF shown(const ImageF& picture, float adaptation, DisplayRange display = {}) const {
        StageRunner runner({rectilinear(picture.width, picture.height, 60)}, selection(), display);
        runner.stage().set_adaptation(adaptation);
        return runner.run(picture, still_input(1));
    }
    ImageD reference(const ImageF& picture, float adaptation, DisplayRange display = {}) const {
        ReferenceFrame frame{convert<double>(picture), rectilinear(picture.width, picture.height, 60), display, {}, 0, false, static_cast<double>(adaptation), 1};
        const auto model = find_model("tone", model_)->create_reference();
        const Selection s = selection();
        model->plan(frame, s.find("tone")->parameters);
        model->apply(frame, s.find("tone")->parameters);
        return frame.image;
    }

    void gpu_is_the_reference(double tolerance_codes) const {
        double worst = 0;
        for (float a : {1e-6f, 1e-3f, 0.1f, 1.0f, 100.0f, 1e4f, 1e8f})
            worst = std::max(worst, summary(code_errors(shown(colour_ramps(257), a), reference(colour_ramps(257), a))).max);
        ledger(name().c_str(), "colours 1e-6..1e8", "float against reference max code", worst);
        EXPECT_LT(worst, tolerance_codes);
    }
    void brighter_is_never_darker() const {
        for (float a : {1e-6f, 1.0f, 1e4f, 1e8f}) {
            const ImageF out = shown(luminance_ramp(4001), a);
            for (int x = 1; x < out.width; ++x)
                for (int c = 0; c < 3; ++c) ASSERT_GE(out.at(x, 0, c), out.at(x - 1, 0, c) * 0.9999990f) << a << " " << x;
        }
    }
    void neutral_stays_neutral() const {
        for (float a : {1e-6f, 1.0f, 1e8f}) {
            const ImageF out = shown(luminance_ramp(4001), a);
            for (int x = 0; x < out.width; ++x)
                for (int c : {0, 2}) ASSERT_LT(std::abs(code(static_cast<double>(out.at(x, 0, c))) - code(static_cast<double>(out.at(x, 0, 1)))), 1e-3);
        }
    }
    void stays_on_the_display() const {
        const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
        for (DisplayRange d : {DisplayRange{130, 0.04f}, DisplayRange{1000, 0}})
            for (const auto& [width, height] : {std::pair{1, 1}, std::pair{101, 27}})
                for (float a : {0.0f, 1e-6f, 1.0f, 1e8f})
                    for (float y : {0.0f, 1e-6f, 1e8f, nan, inf, -1.0f})
                        for (float v : shown(uniform(width, height, y), a, d).data) {
                            ASSERT_TRUE(std::isfinite(v)) << a << " " << y;
                            ASSERT_GE(v, 0.0f);
                            ASSERT_LE(v, d.white_cd_m2);
                        }
    }
    // What other models are told beforehand is what the picture becomes.
    void the_plan_is_what_is_shown(double tolerance = 0.02) const {
        for (float a : {1e-4f, 0.1f, 10.0f, 1e4f}) {
            const ImageF ramp = luminance_ramp(449), out = shown(ramp, a);
            ReferenceFrame frame{convert<double>(ramp), rectilinear(449, 1, 60), {}, {}, 0, false, static_cast<double>(a), 1};
            const Selection s = selection();
            find_model("tone", model_)->create_reference()->plan(frame, s.find("tone")->parameters);
            for (int x = 0; x < 449; x += 7) {
                const double y = static_cast<double>(ramp.at(x, 0, 1));
                EXPECT_LT(relative_error(static_cast<double>(out.at(x, 0, 1)), frame.displayed(y), 1e-3), tolerance) << a << " " << y;
            }
        }
    }

private:
    std::string model_;
    std::vector<std::string> settings_;
};

}  // namespace entoptic::perception::testing
