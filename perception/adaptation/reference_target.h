// What drives the references of the adaptation models, pixel by pixel in double.
#pragma once

#include "perception/model.h"

namespace entoptic::perception {

struct ReferenceWeights {
    double sigma_deg, wide_share, clip_over_median;
    bool retinal;
};
// Gaze-weighted luminance of the frame's picture, cd/m²; 0 when nothing is visible.
double reference_target(const ReferenceFrame& frame, const ReferenceWeights& weights);
// The printed form: weights that are not divided by their sum (trap L2).
double reference_target_as_printed(const ReferenceFrame& frame, double sigma_deg);

}  // namespace entoptic::perception
