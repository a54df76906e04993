#include "runtime/objects/interaction_profiles.h"

#include <algorithm>
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

constexpr Component poses[] = {
    {"/input/grip/pose", pose, Source::grip, hands},
    {"/input/aim/pose", pose, Source::aim, hands},
    {"/input/grip_surface/pose", pose, Source::palm, hands, feature_1_1 | feature_maintenance1},
    {"/input/palm_ext/pose", pose, Source::palm, hands, feature_palm_pose},
    {"/input/pinch_ext/pose", pose, Source::aim, hands, feature_hand_interaction},
    {"/input/poke_ext/pose", pose, Source::aim, hands, feature_hand_interaction},
};

constexpr Component haptic[] = {
    {"/output/haptic", vibration, Source::haptic, hands},
};

constexpr Component stick[] = {
    {"/input/thumbstick", vector2, Source::thumbstick, hands},
    {"/input/thumbstick/x", scalar, Source::thumbstick_x, hands},
    {"/input/thumbstick/y", scalar, Source::thumbstick_y, hands},
    {"/input/thumbstick/click", boolean, Source::thumbstick_click, hands},
};

constexpr Component stick_touch[] = {
    {"/input/thumbstick/touch", boolean, Source::thumbstick_touch, hands},
};

constexpr Component stick_dpad[] = {
    {"/input/thumbstick/dpad_up", boolean, Source::stick_up, hands, feature_dpad},
    {"/input/thumbstick/dpad_down", boolean, Source::stick_down, hands, feature_dpad},
    {"/input/thumbstick/dpad_left", boolean, Source::stick_left, hands, feature_dpad},
    {"/input/thumbstick/dpad_right", boolean, Source::stick_right, hands, feature_dpad},
};

constexpr Component pad[] = {
    {"/input/trackpad", vector2, Source::trackpad, hands},
    {"/input/trackpad/x", scalar, Source::trackpad_x, hands},
    {"/input/trackpad/y", scalar, Source::trackpad_y, hands},
    {"/input/trackpad/touch", boolean, Source::trackpad_touch, hands},
};

constexpr Component pad_click[] = {
    {"/input/trackpad/click", boolean, Source::trackpad_click, hands},
};

constexpr Component pad_force[] = {
    {"/input/trackpad/force", scalar, Source::trackpad_force, hands},
};

constexpr Component pad_dpad[] = {
    {"/input/trackpad/dpad_up", boolean, Source::pad_up, hands, feature_dpad},
    {"/input/trackpad/dpad_down", boolean, Source::pad_down, hands, feature_dpad},
    {"/input/trackpad/dpad_left", boolean, Source::pad_left, hands, feature_dpad},
    {"/input/trackpad/dpad_right", boolean, Source::pad_right, hands, feature_dpad},
    {"/input/trackpad/dpad_center", boolean, Source::pad_center, hands, feature_dpad},
};

constexpr Component faces[] = {
    {"/input/x/click", boolean, Source::a_click, left},
    {"/input/y/click", boolean, Source::b_click, left},
    {"/input/a/click", boolean, Source::a_click, right},
    {"/input/b/click", boolean, Source::b_click, right},
};

constexpr Component face_touches[] = {
    {"/input/x/touch", boolean, Source::a_click, left},
    {"/input/y/touch", boolean, Source::b_click, left},
    {"/input/a/touch", boolean, Source::a_click, right},
    {"/input/b/touch", boolean, Source::b_click, right},
};

constexpr Component menu_left_system_right[] = {
    {"/input/menu/click", boolean, Source::menu_click, left},
    {"/input/system/click", boolean, Source::system_click, right},
};

constexpr Component menu[] = {
    {"/input/menu/click", boolean, Source::menu_click, hands},
};

constexpr Component system_button[] = {
    {"/input/system/click", boolean, Source::system_click, hands},
};

constexpr Component trigger_click[] = {
    {"/input/trigger/click", boolean, Source::trigger, hands},
};

constexpr Component trigger_value[] = {
    {"/input/trigger/value", scalar, Source::trigger, hands},
};

constexpr Component trigger_touch[] = {
    {"/input/trigger/touch", boolean, Source::trigger_touch, hands},
};

constexpr Component squeeze_click[] = {
    {"/input/squeeze/click", boolean, Source::squeeze, hands},
};

constexpr Component squeeze_value[] = {
    {"/input/squeeze/value", scalar, Source::squeeze, hands},
};

constexpr Component thumbrest[] = {
    {"/input/thumbrest/touch", boolean, Source::none, hands},
};

constexpr Component select[] = {
    {"/input/select/click", boolean, Source::select_click, hands},
};

constexpr Component shoulder[] = {
    {"/input/shoulder/click", boolean, Source::none, hands},
};

constexpr Component proximity[] = {
    {"/input/trigger/proximity", boolean, Source::none, hands},
    {"/input/thumb_resting_surfaces/proximity", boolean, Source::none, hands},
};

constexpr Component vive_pro_components[] = {
    {"/input/system/click", boolean, Source::none, head},
    {"/input/volume_up/click", boolean, Source::none, head},
    {"/input/volume_down/click", boolean, Source::none, head},
    {"/input/mute_mic/click", boolean, Source::none, head},
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
    {"/input/thumbstick/dpad_up", boolean, Source::none, gamepad, feature_dpad},
    {"/input/thumbstick/dpad_down", boolean, Source::none, gamepad, feature_dpad},
    {"/input/thumbstick/dpad_left", boolean, Source::none, gamepad, feature_dpad},
    {"/input/thumbstick/dpad_right", boolean, Source::none, gamepad, feature_dpad},
};

constexpr Component back[] = {
    {"/input/back/click", boolean, Source::menu_click, hands},
};

constexpr Component touch_proximity[] = {
    {"/input/trigger/proximity", boolean, Source::none, hands, feature_1_1},
    {"/input/thumb_resting_surfaces/proximity", boolean, Source::none, hands, feature_1_1},
    {"/input/trigger/proximity_fb", boolean, Source::none, hands, feature_touch_proximity},
    {"/input/thumb_fb/proximity_fb", boolean, Source::none, hands, feature_touch_proximity},
};

constexpr Component index_own[] = {
    {"/input/system/touch", boolean, Source::system_click, hands}, {"/input/a/click", boolean, Source::a_click, hands},
    {"/input/a/touch", boolean, Source::a_click, hands},           {"/input/b/click", boolean, Source::b_click, hands},
    {"/input/b/touch", boolean, Source::b_click, hands},           {"/input/squeeze/force", scalar, Source::none, hands},
};

constexpr Component focus3_own[] = {
    {"/input/squeeze/touch", boolean, Source::squeeze, hands},
};

constexpr Component ml2_own[] = {
    {"/input/home/click", boolean, Source::system_click, hands},
};

constexpr Component touch_pro_own[] = {
    {"/input/thumbrest/force", scalar, Source::none, hands},        {"/input/stylus_fb/force", scalar, Source::none, hands},
    {"/input/trigger/curl_fb", scalar, Source::none, hands},        {"/input/trigger/slide_fb", scalar, Source::none, hands},
    {"/input/thumb_fb/proximity_fb", boolean, Source::none, hands}, {"/input/trigger/proximity_fb", boolean, Source::none, hands},
    {"/output/haptic_trigger_fb", vibration, Source::none, hands},  {"/output/haptic_thumb_fb", vibration, Source::none, hands},
};

constexpr Component touch_plus_own[] = {
    {"/input/thumb_meta/proximity_meta", boolean, Source::none, hands},
    {"/input/trigger/proximity_meta", boolean, Source::none, hands},
    {"/input/trigger/curl_meta", scalar, Source::none, hands},
    {"/input/trigger/slide_meta", scalar, Source::none, hands},
    {"/input/trigger/force", scalar, Source::none, hands},
};

constexpr Component meta_pro_own[] = {
    {"/input/thumbrest/force", scalar, Source::none, hands},    {"/input/stylus/force", scalar, Source::none, hands},
    {"/input/trigger_curl/value", scalar, Source::none, hands}, {"/input/trigger_slide/value", scalar, Source::none, hands},
    {"/output/haptic_trigger", vibration, Source::none, hands}, {"/output/haptic_thumb", vibration, Source::none, hands},
};

constexpr Component meta_plus_own[] = {
    {"/input/trigger_curl/value", scalar, Source::none, hands},
    {"/input/trigger_slide/value", scalar, Source::none, hands},
    {"/input/trigger/force", scalar, Source::none, hands},
};

constexpr Component g3_own[] = {
    {"/input/thumbstick", vector2, Source::thumbstick, hands},
    {"/input/thumbstick/click", boolean, Source::thumbstick_click, hands},
};

constexpr Component hand_own[] = {
    {"/input/pinch_ext/value", scalar, Source::trigger, hands},        {"/input/pinch_ext/ready_ext", boolean, Source::ready, hands},
    {"/input/grasp_ext/value", scalar, Source::squeeze, hands},        {"/input/grasp_ext/ready_ext", boolean, Source::ready, hands},
    {"/input/aim_activate_ext/value", scalar, Source::trigger, hands}, {"/input/aim_activate_ext/ready_ext", boolean, Source::ready, hands},
};

constexpr Component eye_components[] = {
    {"/input/gaze_ext/pose", pose, Source::gaze, eyes},
};

constexpr Component menu_left[] = {
    {"/input/menu/click", boolean, Source::menu_click, left},
};

constexpr Component pad_dpad_of_stick[] = {
    {"/input/trackpad/dpad_up", boolean, Source::none, hands, feature_dpad},
    {"/input/trackpad/dpad_down", boolean, Source::none, hands, feature_dpad},
    {"/input/trackpad/dpad_left", boolean, Source::none, hands, feature_dpad},
    {"/input/trackpad/dpad_right", boolean, Source::none, hands, feature_dpad},
    {"/input/trackpad/dpad_center", boolean, Source::none, hands, feature_dpad},
};

using Part = std::span<const Component>;

constexpr Part index_profile[] = {system_button, index_own,  squeeze_value, trigger_click, trigger_value, trigger_touch, stick,
                                  stick_touch,   stick_dpad, pad,           pad_force,     pad_dpad,      poses,         haptic};
constexpr Part vive_profile[] = {system_button, squeeze_click, menu, trigger_click, trigger_value, pad, pad_click, pad_dpad, poses, haptic};
constexpr Part touch_profile[] = {
    faces, face_touches, menu_left_system_right, squeeze_value, trigger_value, trigger_touch, stick, stick_touch, stick_dpad, thumbrest,
    poses, haptic,       touch_proximity};
constexpr Part meta_pro_profile[] = {faces,         face_touches,  menu_left_system_right,
                                     squeeze_value, trigger_value, trigger_touch,
                                     stick,         stick_touch,   stick_dpad,
                                     thumbrest,     poses,         haptic,
                                     proximity,     meta_pro_own};
constexpr Part meta_plus_profile[] = {faces,         face_touches,  menu_left_system_right,
                                      squeeze_value, trigger_value, trigger_touch,
                                      stick,         stick_touch,   stick_dpad,
                                      thumbrest,     poses,         haptic,
                                      proximity,     meta_plus_own};
constexpr Part quest_2_profile[] = {faces,         face_touches,  menu_left_system_right,
                                    squeeze_value, trigger_value, trigger_touch,
                                    stick,         stick_touch,   stick_dpad,
                                    thumbrest,     poses,         haptic,
                                    proximity};
constexpr Part quest_1_profile[] = {
    faces,  face_touches, menu_left_system_right, squeeze_value, trigger_value, trigger_touch, stick, stick_touch, stick_dpad, poses,
    haptic, proximity};
constexpr Part cv1_profile[] = {faces,         face_touches,  menu_left_system_right,
                                squeeze_value, trigger_value, trigger_touch,
                                stick,         stick_touch,   stick_dpad,
                                thumbrest,     poses,         haptic,
                                proximity};
constexpr Part touch_pro_profile[] = {
    faces, face_touches, menu_left_system_right, squeeze_value, trigger_value, trigger_touch, stick, stick_touch, stick_dpad, thumbrest,
    poses, haptic,       touch_pro_own};
constexpr Part touch_plus_profile[] = {
    faces, face_touches, menu_left_system_right, squeeze_value, trigger_value, trigger_touch, stick, stick_touch, stick_dpad, thumbrest,
    poses, haptic,       touch_plus_own};
constexpr Part pico_4_profile[] = {faces,         face_touches,      system_button, menu_left,     squeeze_click,
                                   squeeze_value, trigger_click,     trigger_touch, trigger_value, stick,
                                   stick_touch,   pad_dpad_of_stick, poses,         haptic};
constexpr Part pico_neo3_profile[] = {faces,         face_touches,      system_button, menu,          squeeze_click,
                                      squeeze_value, trigger_click,     trigger_touch, trigger_value, stick,
                                      stick_touch,   pad_dpad_of_stick, poses,         haptic};
constexpr Part focus3_profile[] = {faces,         menu_left_system_right,
                                   squeeze_click, focus3_own,
                                   squeeze_value, trigger_click,
                                   trigger_touch, trigger_value,
                                   stick,         stick_touch,
                                   stick_dpad,    thumbrest,
                                   poses,         haptic};
constexpr Part cosmos_profile[] = {
    faces, menu_left_system_right, shoulder, squeeze_click, trigger_click, trigger_value, stick, stick_touch, stick_dpad, poses, haptic};
constexpr Part hp_profile[] = {faces, menu, squeeze_value, trigger_value, stick, stick_dpad, poses, haptic};
constexpr Part odyssey_profile[] = {menu, squeeze_click, trigger_value, stick, stick_dpad, pad, pad_click, pad_dpad, poses, haptic};
constexpr Part motion_profile[] = {menu, squeeze_click, trigger_value, stick, stick_dpad, pad, pad_click, pad_dpad, poses, haptic};
constexpr Part ml2_profile[] = {menu, ml2_own, trigger_click, trigger_value, pad, pad_click, pad_force, pad_dpad, shoulder, poses, haptic};
constexpr Part pico_g3_profile[] = {trigger_click, trigger_value, menu, g3_own, pad_dpad_of_stick, poses};
constexpr Part simple_profile[] = {select, menu, poses, haptic};
constexpr Part go_profile[] = {system_button, trigger_click, back, pad, pad_click, pad_dpad, poses};
constexpr Part daydream_profile[] = {select, pad, pad_click, pad_dpad, poses};
constexpr Part hand_profile[] = {hand_own, poses};
constexpr Part vive_pro_profile[] = {vive_pro_components};
constexpr Part xbox_profile[] = {xbox_components};
constexpr Part eye_profile[] = {eye_components};

constexpr Profile profiles[] = {
    {"/interaction_profiles/valve/index_controller", "Valve Index Controller", index_profile, 0},
    {"/interaction_profiles/htc/vive_controller", "HTC Vive Controller", vive_profile, 1},
    {"/interaction_profiles/oculus/touch_controller", "Oculus Touch Controller", touch_profile, 2},
    {"/interaction_profiles/meta/touch_pro_controller", "Meta Quest Touch Pro Controller", meta_pro_profile, 3, feature_1_1},
    {"/interaction_profiles/meta/touch_plus_controller", "Meta Quest Touch Plus Controller", meta_plus_profile, 4, feature_1_1},
    {"/interaction_profiles/meta/touch_controller_quest_2", "Quest 2 Controller", quest_2_profile, 5, feature_1_1},
    {"/interaction_profiles/meta/touch_controller_quest_1_rift_s", "Quest / Rift S Controller", quest_1_profile, 6, feature_1_1},
    {"/interaction_profiles/meta/touch_controller_rift_cv1", "Rift CV1 Controller", cv1_profile, 7, feature_1_1},
    {"/interaction_profiles/facebook/touch_controller_pro", "Meta Quest Touch Pro Controller", touch_pro_profile, 8, feature_touch_pro},
    {"/interaction_profiles/meta/touch_controller_plus", "Meta Quest Touch Plus Controller", touch_plus_profile, 9, feature_touch_plus},
    {"/interaction_profiles/bytedance/pico4_controller", "Bytedance PICO 4 Controller", pico_4_profile, 10, feature_1_1 | feature_pico},
    {"/interaction_profiles/bytedance/pico_neo3_controller", "Bytedance PICO Neo3 Controller", pico_neo3_profile, 11,
     feature_1_1 | feature_pico},
    {"/interaction_profiles/htc/vive_focus3_controller", "HTC VIVE Focus 3 Controller", focus3_profile, 12, feature_1_1 | feature_focus3},
    {"/interaction_profiles/htc/vive_cosmos_controller", "HTC VIVE Cosmos Controller", cosmos_profile, 13, feature_1_1 | feature_cosmos},
    {"/interaction_profiles/hp/mixed_reality_controller", "HP Mixed Reality Motion Controller", hp_profile, 14, feature_1_1 | feature_hp},
    {"/interaction_profiles/samsung/odyssey_controller", "Samsung Odyssey Mixed Reality Motion Controller", odyssey_profile, 15,
     feature_1_1 | feature_odyssey},
    {"/interaction_profiles/microsoft/motion_controller", "Microsoft Mixed Reality Motion Controller", motion_profile, 16},
    {"/interaction_profiles/ml/ml2_controller", "Magic Leap 2 Controller", ml2_profile, 17, feature_1_1 | feature_ml2},
    {"/interaction_profiles/bytedance/pico_g3_controller", "Bytedance PICO G3 Controller", pico_g3_profile, 18, feature_1_1 | feature_pico},
    {"/interaction_profiles/khr/simple_controller", "Khronos Simple Controller", simple_profile, 19},
    {"/interaction_profiles/oculus/go_controller", "Oculus Go Controller", go_profile, 20},
    {"/interaction_profiles/google/daydream_controller", "Google Daydream Controller", daydream_profile, 21},
    {"/interaction_profiles/ext/hand_interaction_ext", "Hand", hand_profile, 22, feature_hand_interaction},
    {"/interaction_profiles/htc/vive_pro", "HTC Vive Pro", vive_pro_profile, 0},
    {"/interaction_profiles/microsoft/xbox_controller", "Microsoft Xbox Controller", xbox_profile, 100},
    {"/interaction_profiles/ext/eye_gaze_interaction", "Eye Tracker", eye_profile, 0, feature_eye_gaze},
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
            return click ? 3 : value ? 2 : touch || is_dpad(component.source) ? 0 : component.kind == ComponentKind::boolean ? 1 : 0;
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

const Component* Profile::find(UserPath user, std::string_view below, ComponentKind wanted, Features enabled) const {
    const Component* best = nullptr;
    int best_score = -1;
    for (const std::span<const Component> part : parts) {
        for (const Component& component : part) {
            if ((component.users & bit(user)) == 0 || !available(component.needs, enabled)) continue;
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
    }
    return best;
}

bool Profile::serves(UserPath user) const {
    const auto below = [user](const Component& component) { return (component.users & bit(user)) != 0; };
    return std::any_of(parts.begin(), parts.end(), [&](const auto& part) { return std::any_of(part.begin(), part.end(), below); });
}

std::span<const Profile> interaction_profiles() { return profiles; }

const Profile* find_profile(std::string_view path) {
    for (const Profile& profile : profiles) {
        if (profile.path == path) return &profile;
    }
    return nullptr;
}

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
        case Source::ready:
            return {unit(state.active), 0};
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
        default:
            return {};  // poses, outputs, what no device has; direction pads are made of other components
    }
}

}  // namespace entoptic::runtime
