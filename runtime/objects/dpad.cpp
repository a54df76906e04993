#include "runtime/objects/dpad.h"

#include <cmath>

namespace entoptic::runtime {

namespace {

// Unit vector of a direction; nothing (0, 0) for the centre.
ComponentValue direction_of(Source source) {
    switch (source) {
        case Source::stick_up:
        case Source::pad_up:
            return {0, 1};
        case Source::stick_down:
        case Source::pad_down:
            return {0, -1};
        case Source::stick_left:
        case Source::pad_left:
            return {-1, 0};
        case Source::stick_right:
        case Source::pad_right:
            return {1, 0};
        default:
            return {0, 0};
    }
}

}  // namespace

bool dpad_pressed(Source source, ComponentValue thumb, float press, const DpadSettings& settings, bool was_pressed) {
    const bool held = press >= (was_pressed ? settings.force_threshold_released : settings.force_threshold);
    const float radius = std::hypot(thumb.x, thumb.y);
    const bool stick = dpad_parent(source) == "/input/thumbstick";
    const bool released = !held || (stick && radius < settings.center_region);
    if (released) return false;
    if (was_pressed && settings.sticky) return true;
    if (source == Source::pad_center) return radius < settings.center_region;
    const ComponentValue direction = direction_of(source);
    const float along = (thumb.x * direction.x + thumb.y * direction.y) / std::fmax(radius, 1e-6f);
    return radius >= settings.center_region && std::acos(std::fmin(along, 1.0f)) <= settings.wedge_angle / 2;
}

std::string_view dpad_parent(Source source) {
    if (!is_dpad(source)) return {};
    return source <= Source::stick_right ? "/input/thumbstick" : "/input/trackpad";
}

}  // namespace entoptic::runtime
