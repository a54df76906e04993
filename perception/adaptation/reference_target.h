// What drives the references of the adaptation models, pixel by pixel in double.
#pragma once

#include "perception/model.h"

#include <optional>

namespace entoptic::perception {

struct ReferenceWeights {
    double sigma_deg, wide_share, clip_over_median;
    bool retinal;
};
// Gaze-weighted luminance of the frame's picture, cd/m²; 0 when nothing is visible.
double reference_target(const ReferenceFrame& frame, const ReferenceWeights& weights);
// The printed form: weights that are not divided by their sum (trap L2).
double reference_target_as_printed(const ReferenceFrame& frame, double sigma_deg);

// What most models begin a frame with: the target (cd/m²), at least `floor`, that the state has to approach for frame.dt_s; none when the eye
// has no past, which then sees the target at once, or when a closed lid or a time that does not pass hold the state.
std::optional<double> target_to_approach(ReferenceFrame& frame, double target, double floor);

}  // namespace entoptic::perception
