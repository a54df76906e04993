// Where pictures go: what the configuration's `target` says, and for a real headset that has no panel to be had, a window.
#pragma once

#include "app/config.h"
#include "compositor/targets/target.h"

#include <memory>
#include <string>

namespace entoptic::app {

// The device has to be made for windows: the target is one, or may become one.
bool may_be_window(const Config& config);

struct OpenTarget {
    std::unique_ptr<compositor::DisplayTarget> target;
    bool is_panel = false;
    std::string instead;  // why it is not what the headset deserves, for people; empty when it is
};

// `target` = auto: the panel of a real headset, else a window, else files only; the virtual headset's pictures go to files only.
// `clock` is CLOCK_MONOTONIC's; with `device` it outlives the target. Errors: what was asked for by name cannot be had, and why.
Result<OpenTarget> open_target(gpu::Device& device, Clock& clock, const Config& config, const DisplayIdentity& display,
                               const std::string& application);

}  // namespace entoptic::app
