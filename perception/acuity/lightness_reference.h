// What the references of luidolt_eq12 and krawczyk_larson share: a blur of L* whose width each pixel has for itself, in double.
#pragma once

#include "perception/model.h"

#include <functional>

namespace entoptic::perception {

// Standard deviation of a pixel's kernel, px, of its lightness L* (white is 100 cd/m²), its luminance (cd/m²) and the pixels per degree there.
// 0 or less: sharp.
using LightnessSigma = std::function<double(double lightness, double luminance, double ppd)>;

// Blurs the picture's lightness by a full 2-D sum out to 6 sigma with the C library's erf, lightness by cbrt, pixels per degree from the
// angles between neighbouring pixels' directions: none of the shader's code. Colours follow luminance, brightened at most 16 times.
void blur_lightness(ReferenceFrame& frame, const LightnessSigma& sigma_px);

}  // namespace entoptic::perception
