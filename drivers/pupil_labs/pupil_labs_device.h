// Pupil Labs' eye cameras as a device of drivers.list: an eye tracker to wear with any headset.
#pragma once

#include "drivers/driver.h"
#include "drivers/pupil_labs/pupil_labs_tracker.h"
#include "drivers/v4l2_camera/v4l2_camera.h"

#include <string>
#include <vector>

namespace entoptic::drivers {

extern const Driver pupil_labs_driver;

// The driver's tracker with a tap on its pictures (empty: none). missing: there are no cameras, and what to do.
Result<std::shared_ptr<EyeSource>> open_eye_cameras(Clock& clock, PictureTap tap);

// One camera of theirs that is plugged in, for `entoptic status`.
struct EyeCameraNode {
    CameraNode node;
    int eye = 0;  // 0 left, 1 right
};
std::vector<EyeCameraNode> find_eye_cameras(VideoSystem& system);

// Why there is no eye camera, and what to do: the same words wherever it is said.
std::string no_eye_cameras();

}  // namespace entoptic::drivers
