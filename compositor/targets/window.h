// A window on the desktop (X11): both eyes side by side, what the panel shows or what the eyes see through the lenses.
// Keys: s switches between the two, c says that the wearer looks at the centre now (the eye tracker has slipped), q and Escape close. Needs a device
// made with DeviceOptions::windows.
#pragma once

#include "compositor/targets/target.h"

#include <memory>
#include <string>

namespace entoptic::compositor {

struct WindowOptions {
    PictureSize panel;  // of one eye
    std::string title = "Entoptic";
    bool seen = false;  // begin with what the eyes see
};

// Errors (missing): no X server, or Vulkan cannot draw on it; the message says what to do.
Result<std::unique_ptr<DisplayTarget>> make_window_target(gpu::Device& device, const WindowOptions& options);

}  // namespace entoptic::compositor
