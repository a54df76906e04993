#include "runtime/objects/features.h"

#include "runtime/openxr.h"

#include <string_view>

namespace entoptic::runtime {

namespace {

struct Row {
    std::string_view extension;
    Feature feature;
};

constexpr Row rows[] = {
    {"XR_KHR_maintenance1", feature_maintenance1},
    {"XR_EXT_palm_pose", feature_palm_pose},
    {"XR_EXT_hand_interaction", feature_hand_interaction},
    {"XR_EXT_dpad_binding", feature_dpad},
    {"XR_EXT_eye_gaze_interaction", feature_eye_gaze},
    {"XR_HTC_vive_cosmos_controller_interaction", feature_cosmos},
    {"XR_HTC_vive_focus3_controller_interaction", feature_focus3},
    {"XR_EXT_samsung_odyssey_controller", feature_odyssey},
    {"XR_EXT_hp_mixed_reality_controller", feature_hp},
    {"XR_ML_ml2_controller_interaction", feature_ml2},
    {"XR_BD_controller_interaction", feature_pico},
    {"XR_FB_touch_controller_pro", feature_touch_pro},
    {"XR_META_touch_controller_plus", feature_touch_plus},
    {"XR_FB_touch_controller_proximity", feature_touch_proximity},
    {"XR_KHR_locate_spaces", feature_locate_spaces},
    {"XR_EXT_local_floor", feature_local_floor},
    {"XR_VARJO_quad_views", feature_quad_views},
};

}  // namespace

Features features_of(std::uint64_t api_version, std::span<const std::string> extensions) {
    Features enabled = api_version >= XR_MAKE_VERSION(1, 1, 0) ? Features(feature_1_1) : 0u;
    for (const std::string& extension : extensions) {
        for (const Row& row : rows) enabled |= row.extension == extension ? Features(row.feature) : 0u;
    }
    return enabled;
}

}  // namespace entoptic::runtime
