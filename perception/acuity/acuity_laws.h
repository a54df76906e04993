// For tests: what the acuity models on local_blur.h keep true, as functions that take the model's name. Header-only.
#pragma once

#include "perception/testing/picture_laws.h"

namespace entoptic::perception::testing {

class AcuityLaws : public PictureLaws {
public:
    explicit AcuityLaws(std::string model) : PictureLaws("acuity", std::move(model)) {}

    // The Gaussian stack's tolerances (acuity_pareto: 1.45). Widths that change within a patch of noise cost more.
    static PictureTolerance stack_tolerance(const PictureCase& c, bool random, double least_effect_p99) {
        return {random ? 12 : c.lamp > 0 ? 2.0 : 1.45, random ? 1.5 : 0.2, least_effect_p99};
    }
    void noise_does_not_depend_on_the_frame_rate(const std::vector<std::string>& settings) const {
        const ImageF picture = textured(120, 80, 0.01);
        const auto after = [&](int frames, double seconds) {
            StageRunner runner({rectilinear(120, 80, 10)}, with_exposure(selection(settings), 60));
            ImageF out;
            for (int i = 0; i < frames; ++i) out = runner.run(picture, still_input(1, seconds / frames, false));
            return out;
        };
        const ImageF once = after(1, 0.5);
        EXPECT_LT(summary(relative_errors(after(45, 0.5), once, 1e-4)).max, 1e-3);
        EXPECT_GT(summary(relative_errors(after(1, 0.2), once, 1e-4)).max, 0.1);
    }
};

// Chequered by 5 %, so that any blur shows.
inline ImageF chequered(int width, int height, float y) {
    ImageF picture = uniform(width, height, y);
    const auto row = static_cast<std::size_t>(width);
    for (std::size_t i = 0; i < picture.data.size(); ++i) picture.data[i] *= (i / 3 + i / (3 * row)) % 2 ? 1.05f : 0.95f;
    return picture;
}

}  // namespace entoptic::perception::testing
