#include "runtime/objects/interaction_profiles.h"

#include <array>
#include <cctype>
#include <cmath>

namespace entoptic::runtime {

namespace {

constexpr std::uint8_t bit(UserPath user) { return static_cast<std::uint8_t>(1u << static_cast<unsigned>(user)); }
constexpr std::uint8_t left = bit(UserPath::left_hand), right = bit(UserPath::right_hand), hands = left | right;
constexpr std::uint8_t head = bit(UserPath::head), gamepad = bit(UserPath::gamepad), eyes = bit(UserPath::eyes);
constexpr ComponentKind boolean = ComponentKind::boolean, scalar = ComponentKind::scalar, vector2 = ComponentKind::vector2;
constexpr ComponentKind pose = ComponentKind::pose, vibration = ComponentKind::haptic;

constexpr Component simple_components[] = {
    {"/input/select/click", boolean, Source::select_click, hands},
    {"/input/menu/click", boolean, Source::menu_click, hands},
    {"/input/grip/pose", pose, Source::grip, hands},
    {"/input/aim/pose", pose, Source::aim, hands},
    {"/output/haptic", vibration, Source::haptic, hands},
};

constexpr Component daydream_components[] = {
    {"/input/select/click", boolean, Source::select_click, hands},
    {"/input/trackpad", vector2, Source::trackpad, hands},
    {"/input/trackpad/x", scalar, Source::trackpad_x, hands},
    {"/input/trackpad/y", scalar, Source::trackpad_y, hands},
    {"/input/trackpad/click", boolean, Source::trackpad_click, hands},
    {"/input/trackpad/touch", boolean, Source::trackpad_touch, hands},
    {"/input/grip/pose", pose, Source::grip, hands},
    {"/input/aim/pose", pose, Source::aim, hands},
};

constexpr Component vive_components[] = {
    {"/input/system/click", boolean, Source::system_click, hands},
    {"/input/squeeze/click", boolean, Source::squeeze, hands},
    {"/input/menu/click", boolean, Source::menu_click, hands},
    {"/input/trigger/click", boolean, Source::trigger, hands},
    {"/input/trigger/value", scalar, Source::trigger, hands},
    {"/input/trackpad", vector2, Source::trackpad, hands},
    {"/input/trackpad/x", scalar, Source::trackpad_x, hands},
    {"/input/trackpad/y", scalar, Source::trackpad_y, hands},
    {"/input/trackpad/click", boolean, Source::trackpad_click, hands},
    {"/input/trackpad/touch", boolean, Source::trackpad_touch, hands},
    {"/input/grip/pose", pose, Source::grip, hands},
    {"/input/aim/pose", pose, Source::aim, hands},
    {"/output/haptic", vibration, Source::haptic, hands},
};

constexpr Component vive_pro_components[] = {
    {"/input/system/click", boolean, Source::none, head},
    {"/input/volume_up/click", boolean, Source::none, head},
    {"/input/volume_down/click", boolean, Source::none, head},
    {"/input/mute_mic/click", boolean, Source::none, head},
};

constexpr Component motion_components[] = {
    {"/input/menu/click", boolean, Source::menu_click, hands},
    {"/input/squeeze/click", boolean, Source::squeeze, hands},
    {"/input/trigger/value", scalar, Source::trigger, hands},
    {"/input/thumbstick", vector2, Source::thumbstick, hands},
    {"/input/thumbstick/x", scalar, Source::thumbstick_x, hands},
    {"/input/thumbstick/y", scalar, Source::thumbstick_y, hands},
    {"/input/thumbstick/click", boolean, Source::thumbstick_click, hands},
    {"/input/trackpad", vector2, Source::trackpad, hands},
    {"/input/trackpad/x", scalar, Source::trackpad_x, hands},
    {"/input/trackpad/y", scalar, Source::trackpad_y, hands},
    {"/input/trackpad/click", boolean, Source::trackpad_click, hands},
    {"/input/trackpad/touch", boolean, Source::trackpad_touch, hands},
    {"/input/grip/pose", pose, Source::grip, hands},
    {"/input/aim/pose", pose, Source::aim, hands},
    {"/output/haptic", vibration, Source::haptic, hands},
};

constexpr Component xbox_components[] = {
    {"/input/menu/click", boolean, Source::none, gamepad},
    {"/input/view/click", boolean, Source::none, gamepad},
    {"/input/a/click", boolean, Source::none, gamepad},
    {"/input/b/click", boolean, Source::none, gamepad},
    {"/input/x/click", boolean, Source::none, gamepad},
    {"/input/y/click", boolean, Source::none, gamepad},
    {"/input/dpad_down/click", boolean, Source::none, gamepad},
    {"/input/dpad_right/click", boolean, Source::none, gamepad},
    {"/input/dpad_up/click", boolean, Source::none, gamepad},
    {"/input/dpad_left/click", boolean, Source::none, gamepad},
    {"/input/shoulder_left/click", boolean, Source::none, gamepad},
    {"/input/shoulder_right/click", boolean, Source::none, gamepad},
    {"/input/thumbstick_left/click", boolean, Source::none, gamepad},
    {"/input/thumbstick_right/click", boolean, Source::none, gamepad},
    {"/input/trigger_left/value", scalar, Source::none, gamepad},
    {"/input/trigger_right/value", scalar, Source::none, gamepad},
    {"/input/thumbstick_left", vector2, Source::none, gamepad},
    {"/input/thumbstick_left/x", scalar, Source::none, gamepad},
    {"/input/thumbstick_left/y", scalar, Source::none, gamepad},
    {"/input/thumbstick_right", vector2, Source::none, gamepad},
    {"/input/thumbstick_right/x", scalar, Source::none, gamepad},
    {"/input/thumbstick_right/y", scalar, Source::none, gamepad},
    {"/output/haptic_left", vibration, Source::none, gamepad},
    {"/output/haptic_right", vibration, Source::none, gamepad},
    {"/output/haptic_left_trigger", vibration, Source::none, gamepad},
    {"/output/haptic_right_trigger", vibration, Source::none, gamepad},
};

constexpr Component go_components[] = {
    {"/input/system/click", boolean, Source::system_click, hands},
    {"/input/trigger/click", boolean, Source::trigger, hands},
    {"/input/back/click", boolean, Source::menu_click, hands},
    {"/input/trackpad", vector2, Source::trackpad, hands},
    {"/input/trackpad/x", scalar, Source::trackpad_x, hands},
    {"/input/trackpad/y", scalar, Source::trackpad_y, hands},
    {"/input/trackpad/click", boolean, Source::trackpad_click, hands},
    {"/input/trackpad/touch", boolean, Source::trackpad_touch, hands},
    {"/input/grip/pose", pose, Source::grip, hands},
    {"/input/aim/pose", pose, Source::aim, hands},
};

constexpr Component touch_components[] = {
    {"/input/x/click", boolean, Source::a_click, left},
    {"/input/x/touch", boolean, Source::a_click, left},
    {"/input/y/click", boolean, Source::b_click, left},
    {"/input/y/touch", boolean, Source::b_click, left},
    {"/input/menu/click", boolean, Source::menu_click, left},
    {"/input/a/click", boolean, Source::a_click, right},
    {"/input/a/touch", boolean, Source::a_click, right},
    {"/input/b/click", boolean, Source::b_click, right},
    {"/input/b/touch", boolean, Source::b_click, right},
    {"/input/system/click", boolean, Source::system_click, right},
    {"/input/squeeze/value", scalar, Source::squeeze, hands},
    {"/input/trigger/value", scalar, Source::trigger, hands},
    {"/input/trigger/touch", boolean, Source::trigger_touch, hands},
    {"/input/thumbstick", vector2, Source::thumbstick, hands},
    {"/input/thumbstick/x", scalar, Source::thumbstick_x, hands},
    {"/input/thumbstick/y", scalar, Source::thumbstick_y, hands},
    {"/input/thumbstick/click", boolean, Source::thumbstick_click, hands},
    {"/input/thumbstick/touch", boolean, Source::thumbstick_touch, hands},
    {"/input/thumbrest/touch", boolean, Source::none, hands},
    {"/input/grip/pose", pose, Source::grip, hands},
    {"/input/aim/pose", pose, Source::aim, hands},
    {"/output/haptic", vibration, Source::haptic, hands},
};

constexpr Component index_components[] = {
    {"/input/system/click", boolean, Source::system_click, hands},
    {"/input/system/touch", boolean, Source::system_click, hands},
    {"/input/a/click", boolean, Source::a_click, hands},
    {"/input/a/touch", boolean, Source::a_click, hands},
    {"/input/b/click", boolean, Source::b_click, hands},
    {"/input/b/touch", boolean, Source::b_click, hands},
    {"/input/squeeze/value", scalar, Source::squeeze, hands},
    {"/input/squeeze/force", scalar, Source::none, hands},
    {"/input/trigger/click", boolean, Source::trigger, hands},
    {"/input/trigger/value", scalar, Source::trigger, hands},
    {"/input/trigger/touch", boolean, Source::trigger_touch, hands},
    {"/input/thumbstick", vector2, Source::thumbstick, hands},
    {"/input/thumbstick/x", scalar, Source::thumbstick_x, hands},
    {"/input/thumbstick/y", scalar, Source::thumbstick_y, hands},
    {"/input/thumbstick/click", boolean, Source::thumbstick_click, hands},
    {"/input/thumbstick/touch", boolean, Source::thumbstick_touch, hands},
    {"/input/trackpad", vector2, Source::trackpad, hands},
    {"/input/trackpad/x", scalar, Source::trackpad_x, hands},
    {"/input/trackpad/y", scalar, Source::trackpad_y, hands},
    {"/input/trackpad/force", scalar, Source::trackpad_force, hands},
    {"/input/trackpad/touch", boolean, Source::trackpad_touch, hands},
    {"/input/grip/pose", pose, Source::grip, hands},
    {"/input/aim/pose", pose, Source::aim, hands},
    {"/output/haptic", vibration, Source::haptic, hands},
};

constexpr Component eye_components[] = {
    {"/input/gaze_ext/pose", pose, Source::gaze, eyes},
};

constexpr Profile profiles[] = {
    {"/interaction_profiles/valve/index_controller", "Valve Index Controller", index_components, 0},
    {"/interaction_profiles/htc/vive_controller", "HTC Vive Controller", vive_components, 1},
    {"/interaction_profiles/oculus/touch_controller", "Oculus Touch Controller", touch_components, 2},
    {"/interaction_profiles/microsoft/motion_controller", "Microsoft Mixed Reality Motion Controller", motion_components, 3},
    {"/interaction_profiles/khr/simple_controller", "Khronos Simple Controller", simple_components, 4},
    {"/interaction_profiles/oculus/go_controller", "Oculus Go Controller", go_components, 5},
    {"/interaction_profiles/google/daydream_controller", "Google Daydream Controller", daydream_components, 6},
    {"/interaction_profiles/htc/vive_pro", "HTC Vive Pro", vive_pro_components, 0},
    {"/interaction_profiles/microsoft/xbox_controller", "Microsoft Xbox Controller", xbox_components, 100},
    {"/interaction_profiles/ext/eye_gaze_interaction", "Eye Tracker", eye_components, 0},
};

struct UserPathText {
    std::string_view path, name;
};
constexpr std::array<UserPathText, user_path_count> user_paths{{{"/user/hand/left", "Left Hand"},
                                                                {"/user/hand/right", "Right Hand"},
                                                                {"/user/head", "Head"},
                                                                {"/user/gamepad", "Gamepad"},
                                                                {"/user/treadmill", "Treadmill"},
                                                                {"/user/eyes_ext", "Eyes"}}};

float clean(float value, float low) { return std::isfinite(value) ? std::fmin(std::fmax(value, low), 1.0f) : 0.0f; }
float unit(bool value) { return value ? 1.0f : 0.0f; }

// How well a component suits an action that named its identifier only; 0: not at all.
int suitability(const Component& component, ComponentKind wanted) {
    const std::string_view last = component.path.substr(component.path.rfind('/'));
    const bool click = last == "/click", value = last == "/value", touch = last == "/touch";
    switch (wanted) {
        case ComponentKind::boolean:
            return click ? 3 : value ? 2 : touch ? 0 : component.kind == ComponentKind::boolean ? 1 : 0;
        case ComponentKind::scalar:
            return value ? 3 : click ? 2 : component.kind == ComponentKind::scalar ? 1 : 0;
        default:
            return component.kind == wanted ? 3 : 0;
    }
}

}  // namespace

std::string_view user_path_text(UserPath user) { return user_paths[static_cast<std::size_t>(user)].path; }
std::string_view user_path_name(UserPath user) { return user_paths[static_cast<std::size_t>(user)].name; }

std::optional<UserPath> parse_user_path(std::string_view text) {
    for (int i = 0; i < user_path_count; ++i) {
        if (user_paths[static_cast<std::size_t>(i)].path == text) return static_cast<UserPath>(i);
    }
    return std::nullopt;
}

std::optional<SplitPath> split_binding_path(std::string_view path) {
    for (int i = 0; i < user_path_count; ++i) {
        const std::string_view user = user_paths[static_cast<std::size_t>(i)].path;
        if (path.size() > user.size() && path.starts_with(user) && path[user.size()] == '/') {
            return SplitPath{static_cast<UserPath>(i), path.substr(user.size())};
        }
    }
    return std::nullopt;
}

std::string_view identifier_of(std::string_view below) {
    const std::size_t second = below.find('/', 1);
    if (second == std::string_view::npos) return below;
    const std::size_t third = below.find('/', second + 1);
    return below.substr(0, third);
}

std::string component_name(std::string_view below) {
    std::string_view identifier = identifier_of(below);
    identifier.remove_prefix(identifier.rfind('/') + 1);
    if (identifier.ends_with("_ext")) identifier.remove_suffix(4);
    std::string name(identifier);
    bool start = true;
    for (char& c : name) {
        if (c == '_')
            c = ' ';
        else if (start)
            c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        start = c == ' ';
    }
    const std::string_view rest = below.substr(identifier_of(below).size());
    if (rest == "/x") return name + " X";
    if (rest == "/y") return name + " Y";
    if (rest == "/touch") return name + " Touch";
    return name;
}

const Component* Profile::find(UserPath user, std::string_view below, ComponentKind wanted) const {
    const Component* best = nullptr;
    int best_score = -1;
    for (const Component& component : components) {
        if ((component.users & bit(user)) == 0) continue;
        const bool exact = component.path == below;
        // "/input/thumbstick" is itself a component (a vector); an action of another type means its click or value.
        if (exact && (component.kind != ComponentKind::vector2 || wanted == ComponentKind::vector2)) return &component;
        if (!exact && identifier_of(component.path) != below) continue;
        const int score = suitability(component, wanted);
        if (score > best_score) {
            best = &component;
            best_score = score;
        }
    }
    return best;
}

std::span<const Profile> interaction_profiles() { return profiles; }

const Profile* find_profile(std::string_view path) {
    for (const Profile& profile : profiles) {
        if (profile.path == path) return &profile;
    }
    return nullptr;
}

bool is_eye_gaze_profile(const Profile& profile) { return profile.components.data() == eye_components; }

ComponentValue read_component(Source source, const ControllerState& state) {
    switch (source) {
        case Source::trigger:
            return {clean(state.trigger, 0), 0};
        case Source::trigger_touch:
            return {unit(state.trigger_touch || state.trigger > 0), 0};
        case Source::squeeze:
            return {clean(state.squeeze, 0), 0};
        case Source::thumbstick:
            return {clean(state.thumbstick.x, -1), clean(state.thumbstick.y, -1)};
        case Source::thumbstick_x:
            return {clean(state.thumbstick.x, -1), 0};
        case Source::thumbstick_y:
            return {clean(state.thumbstick.y, -1), 0};
        case Source::thumbstick_click:
            return {unit(state.thumbstick_click), 0};
        case Source::thumbstick_touch:
            return {unit(state.thumbstick_touch || state.thumbstick_click), 0};
        case Source::trackpad:
            return {clean(state.trackpad.x, -1), clean(state.trackpad.y, -1)};
        case Source::trackpad_x:
            return {clean(state.trackpad.x, -1), 0};
        case Source::trackpad_y:
            return {clean(state.trackpad.y, -1), 0};
        case Source::trackpad_click:
            return {unit(state.trackpad_click), 0};
        case Source::trackpad_touch:
            return {unit(state.trackpad_touch || state.trackpad_click), 0};
        case Source::trackpad_force:
            return {unit(state.trackpad_click), 0};
        case Source::a_click:
            return {unit(state.a_click), 0};
        case Source::b_click:
            return {unit(state.b_click), 0};
        case Source::menu_click:
            return {unit(state.menu_click), 0};
        case Source::system_click:
            return {unit(state.system_click), 0};
        // A device that presents itself with a select button has no other trigger.
        case Source::select_click:
            return {state.select_click ? 1.0f : clean(state.trigger, 0), 0};
        case Source::none:
        case Source::grip:
        case Source::aim:
        case Source::gaze:
        case Source::haptic:
            break;
    }
    return {};
}

}  // namespace entoptic::runtime
