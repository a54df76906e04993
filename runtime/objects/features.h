// What an application's version of OpenXR and its extensions make available: one bit each, for tables whose rows need some of them.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace entoptic::runtime {

using Features = std::uint32_t;

enum Feature : Features {
    feature_1_1 = 1u << 0,  // the application asked for OpenXR 1.1
    feature_maintenance1 = 1u << 1,
    feature_palm_pose = 1u << 2,
    feature_hand_interaction = 1u << 3,
    feature_dpad = 1u << 4,
    feature_eye_gaze = 1u << 5,
    feature_cosmos = 1u << 6,
    feature_focus3 = 1u << 7,
    feature_odyssey = 1u << 8,
    feature_hp = 1u << 9,
    feature_ml2 = 1u << 10,
    feature_pico = 1u << 11,
    feature_touch_pro = 1u << 12,
    feature_touch_plus = 1u << 13,
    feature_touch_proximity = 1u << 14,
    feature_locate_spaces = 1u << 15,
    feature_local_floor = 1u << 16,
    feature_quad_views = 1u << 17,
};

// `api_version`: XrApplicationInfo::apiVersion.
Features features_of(std::uint64_t api_version, std::span<const std::string> extensions);

// True when a row that needs any of `needs` is there for an application with `enabled`. No needs: for everyone.
constexpr bool available(Features needs, Features enabled) { return needs == 0 || (needs & enabled) != 0; }

}  // namespace entoptic::runtime
