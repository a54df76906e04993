// Where the target of a calibration stands before the wearer.
#pragma once

#include "drivers/eye_tracking/gaze_angles.h"
#include "interfaces/headset.h"

namespace entoptic::app {

constexpr double target_distance_m = 2;

// Head coordinates, metres. `target_deg` is seen from between the eyes.
inline glm::dvec3 target_point(drivers::GazeAngles target_deg) { return target_distance_m * drivers::direction_of(target_deg); }

// Where this eye has to look for it, degrees: it does not sit between the eyes.
inline drivers::GazeAngles target_of_eye(const Headset& headset, std::size_t eye, drivers::GazeAngles target_deg) {
    return drivers::angles_of(target_point(target_deg) - glm::dvec3(headset.eyes[eye].head_from_eye.position));
}

}  // namespace entoptic::app
