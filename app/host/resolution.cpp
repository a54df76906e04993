#include "app/host/resolution.h"

#include "perception/acuity/larson_increment_math.glsl"

#include <algorithm>
#include <cmath>

namespace entoptic::app {

double resolved_angle_rad(double cd_m2) {
    const double cycles_per_degree = std::max(perception::larson_increment::resolved_cpd(cd_m2), 0.1);
    return M_PI / 180 / (2 * cycles_per_degree);
}

}  // namespace entoptic::app
