// A UVC camera through libusb, past the kernel's driver: for two cameras on one bus, of which that driver can open only one because it reserves
// the room that the camera asks for instead of what it needs (facts/devices.md 3.4).
#pragma once

#include "drivers/uvc_camera/uvc_protocol.h"
#include "drivers/v4l2_camera/frame_stream.h"

#include <memory>
#include <string>

namespace entoptic::drivers {

// Opens the camera whose product string is `product`, takes it from the kernel's driver until it is closed, and streams `mode` at the smallest
// alternate setting that holds it. `clock` must be CLOCK_MONOTONIC's and outlive the stream. One thread at a time; opening is not thread-safe over
// several cameras.
CameraResult<std::unique_ptr<FrameStream>> open_uvc_camera(const std::string& product, const CameraMode& mode, const Clock& clock);

}  // namespace entoptic::drivers
