#include "perception/pupil/watson_yellott.h"

#include "perception/pupil/watson_yellott_math.glsl"

#include <algorithm>

namespace entoptic::perception {
namespace {

// NaN becomes `low`.
double within(double value, double low, double high) { return value > low ? std::min(value, high) : low; }

}  // namespace

double pupil_diameter_mm(double luminance_cd_m2, double age, double area_deg2, int eyes) {
    const double flux = within(luminance_cd_m2, 0, 1e8) * within(area_deg2, 0, 41253) * (eyes == 1 ? 0.1 : 1.0);
    return std::clamp(watson_yellott::diameter_mm(flux, within(age, 20, 83)), 1.5, 9.0);
}

}  // namespace entoptic::perception
