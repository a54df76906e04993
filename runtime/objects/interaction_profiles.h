// The interaction profiles of OpenXR 1.0 and 1.1 and of the extensions in objects/features.h: which paths each has, and where the devices
// take their values from. Facts from the specification's registry.
#pragma once

#include "interfaces/sources.h"
#include "runtime/objects/features.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace entoptic::runtime {

enum class ComponentKind : std::uint8_t { boolean, scalar, vector2, pose, haptic };

// The top-level user paths this runtime knows.
enum class UserPath : std::uint8_t { left_hand, right_hand, head, gamepad, treadmill, eyes };
constexpr int user_path_count = 6;
std::string_view user_path_text(UserPath user);
std::string_view user_path_name(UserPath user);  // for people: "Left Hand"
std::optional<UserPath> parse_user_path(std::string_view text);

// What a component reads of a device. `none`: the virtual device does not have it, it stays at rest.
enum class Source : std::uint8_t {
    none,
    trigger,
    trigger_touch,
    squeeze,
    thumbstick,
    thumbstick_x,
    thumbstick_y,
    thumbstick_click,
    thumbstick_touch,
    trackpad,
    trackpad_x,
    trackpad_y,
    trackpad_click,
    trackpad_touch,
    trackpad_force,
    a_click,
    b_click,
    menu_click,
    system_click,
    select_click,
    ready,  // on while the device is there: a hand seen well enough to gesture
    grip,
    aim,
    palm,
    gaze,
    haptic,
    // A direction pad made of a stick or pad (XR_EXT_dpad_binding).
    stick_up,
    stick_down,
    stick_left,
    stick_right,
    pad_up,
    pad_down,
    pad_left,
    pad_right,
    pad_center
};
constexpr bool is_dpad(Source source) { return source >= Source::stick_up; }

struct Component {
    std::string_view path;  // below the user path: "/input/trigger/value"
    ComponentKind kind;
    Source source;
    std::uint8_t users;  // bit 1 << UserPath
    Features needs = 0;  // any of them makes it available; 0: there for everyone who has the profile
};

struct Profile {
    std::string_view path;                              // "/interaction_profiles/valve/index_controller"
    std::string_view name;                              // for people
    std::span<const std::span<const Component>> parts;  // its components, in groups that profiles share
    int preference;                                     // hand controllers take the lowest that the application suggests; 100: never
    Features needs = 0;                                 // any of them makes it available

    // The component that a binding path below `user` names: exact, or by its identifier alone ("/input/trigger"), where the component
    // is chosen to suit `wanted`. Null when the profile has no such path with these features.
    const Component* find(UserPath user, std::string_view below, ComponentKind wanted, Features enabled) const;
    // True when some component lies below this user path.
    bool serves(UserPath user) const;
};

std::span<const Profile> interaction_profiles();
// Also those that the application's features do not make available.
const Profile* find_profile(std::string_view path);

// "/user/hand/left/input/trigger/value" in its user path and the rest. Nothing when it does not begin with a known user path.
struct SplitPath {
    UserPath user;
    std::string_view below;
};
std::optional<SplitPath> split_binding_path(std::string_view path);
// "/input/trigger/value" -> "/input/trigger".
std::string_view identifier_of(std::string_view below);
// "/input/trigger/value" -> "Trigger".
std::string component_name(std::string_view below);

// Values of a component, as read; a boolean is 0 or 1 in x.
struct ComponentValue {
    float x = 0, y = 0;
};
ComponentValue read_component(Source source, const ControllerState& state);

}  // namespace entoptic::runtime
