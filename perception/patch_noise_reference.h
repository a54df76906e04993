// patch_noise.glsl in double by its definition as a weighted sum, with none of its code.
#pragma once

#include "perception/model.h"

namespace entoptic::perception {

// Noise where `direction` (unit, as the geometry's) is seen, in cells of `cell_deg` around the gaze, `ticks` of its clock after the start:
// mean 0, variance 1, within ±4.
double patch_noise_reference(const ReferenceFrame& frame, const glm::dvec3& direction, double cell_deg, double ticks);

}  // namespace entoptic::perception
