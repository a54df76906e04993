// Gaze as two angles and as a direction (Fick's coordinates, as eye trackers give them).
#pragma once

#include <cmath>
#include <glm/glm.hpp>

namespace entoptic::drivers {

constexpr double degrees_per_radian = 57.29577951308232;

// Degrees to the right and up of straight ahead, in head coordinates.
using GazeAngles = glm::dvec2;

// Unit vector, head coordinates (x right, y up, -z forward).
inline glm::dvec3 direction_of(GazeAngles angles_deg) {
    const double right = angles_deg.x / degrees_per_radian, up = angles_deg.y / degrees_per_radian;
    return {std::sin(right) * std::cos(up), std::sin(up), -std::cos(right) * std::cos(up)};
}

// `direction` need not be a unit vector, but must be finite and not zero.
inline GazeAngles angles_of(glm::dvec3 direction) {
    const double up = std::atan2(direction.y, std::hypot(direction.x, direction.z));
    return glm::dvec2{std::atan2(direction.x, -direction.z), up} * degrees_per_radian;
}

}  // namespace entoptic::drivers
