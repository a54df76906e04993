// Field of view of a lens as Valve's calibration gives it.
#pragma once

#include "base/pose.h"
#include "interfaces/headset.h"

namespace entoptic::drivers {

// The rectilinear view that fills the undistorted render target of `lens`: the directions of its borders X = ±(1+grow), Y = ±(1+grow)
// through the intrinsics (interfaces/headset.h, Lens). Radians; left and down are negative. Source: facts/devices.md 1.4.
Fov lens_fov(const Lens& lens);

}  // namespace entoptic::drivers
