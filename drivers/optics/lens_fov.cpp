#include "drivers/optics/lens_fov.h"

#include <cmath>

namespace entoptic::drivers {

Fov lens_fov(const Lens& lens) {
    const double border = 1.0 + double(lens.grow_for_undistort);
    const double fx = lens.focal.x, fy = lens.focal.y, cx = lens.principal_point.x, cy = lens.principal_point.y;
    return {static_cast<float>(std::atan((cx - border) / fx)), static_cast<float>(std::atan((cx + border) / fx)),
            static_cast<float>(std::atan((cy + border) / fy)), static_cast<float>(std::atan((cy - border) / fy))};
}

}  // namespace entoptic::drivers
