// The calibration in a person's file (observer_file.h):
//
//   [gaze]
//   left = [[0.3, 20.1, 0, 0, 0, 0], [-0.2, 0, 19.8, 0, 0, 0]]    # right and up: the terms of eye_tracking/eye_calibration.h
//   right = ...
//   [pupil]
//   narrowest_mm = 2.4
//   widest_mm = 6.8
#pragma once

#include "base/result.h"
#include "drivers/eye_tracking/eye_calibration.h"

#include <string>

namespace entoptic::app {

// Empty when the file says nothing of it, or no observer is chosen. Errors name file and line.
Result<drivers::EyeCalibration> read_calibration(const std::string& observer);

// Puts what `calibration` holds into observers/NAME.toml, keeping everything else there (but comments); makes the file where there is none, from the
// observer of that name who comes with the program if there is one.
// Returns its path.
Result<std::string> write_calibration(const std::string& observer, const drivers::EyeCalibration& calibration);

}  // namespace entoptic::app
