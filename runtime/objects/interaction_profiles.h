// The interaction profiles of OpenXR 1.0 (and of XR_EXT_eye_gaze_interaction): which paths each has, and where the virtual devices
// take their values from. Facts from the specification's registry.
#pragma once

#include "interfaces/sources.h"

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
    grip,
    aim,
    gaze,
    haptic
};

struct Component {
    std::string_view path;  // below the user path: "/input/trigger/value"
    ComponentKind kind;
    Source source;
    std::uint8_t users;  // bit 1 << UserPath
};

struct Profile {
    std::string_view path;  // "/interaction_profiles/valve/index_controller"
    std::string_view name;  // for people
    std::span<const Component> components;
    int preference;  // the virtual controllers take the lowest that the application suggests; 100: never

    // The component that a binding path below `user` names: exact, or by its identifier alone ("/input/trigger"), where the component
    // is chosen to suit `wanted`. Null when the profile has no such path.
    const Component* find(UserPath user, std::string_view below, ComponentKind wanted) const;
};

// Every profile; the eye gaze profile is the last and belongs to the extension.
std::span<const Profile> interaction_profiles();
const Profile* find_profile(std::string_view path);
bool is_eye_gaze_profile(const Profile& profile);

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
