#include "runtime/api/extensions.h"

namespace entoptic::runtime::api {

namespace {

// Sorted by name. Names and revisions that Debian's headers lack, or that need headers of a graphics API, are spelled out; the revisions are those of the
// registry of OpenXR 1.1.41.
const Extension offered[] = {
    {"XR_BD_controller_interaction", 2},
    {XR_ENTOPTICX_OBSERVER_EXTENSION_NAME, XR_ENTOPTICX_observer_SPEC_VERSION},
    {XR_ENTOPTICX_PRESENTATION_TIMING_EXTENSION_NAME, XR_ENTOPTICX_presentation_timing_SPEC_VERSION},
    {XR_ENTOPTICX_SCENE_LUMINANCE_EXTENSION_NAME, XR_ENTOPTICX_scene_luminance_SPEC_VERSION},
    {XR_EXT_CONFORMANCE_AUTOMATION_EXTENSION_NAME, XR_EXT_conformance_automation_SPEC_VERSION},
    {XR_EXT_DEBUG_UTILS_EXTENSION_NAME, XR_EXT_debug_utils_SPEC_VERSION},
    {XR_EXT_DPAD_BINDING_EXTENSION_NAME, 1, XR_KHR_BINDING_MODIFICATION_EXTENSION_NAME},
    {XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME, XR_EXT_eye_gaze_interaction_SPEC_VERSION},
    {XR_EXT_HAND_INTERACTION_EXTENSION_NAME, 1},
    {XR_EXT_HAND_TRACKING_EXTENSION_NAME, XR_EXT_hand_tracking_SPEC_VERSION},
    {XR_EXT_HP_MIXED_REALITY_CONTROLLER_EXTENSION_NAME, XR_EXT_hp_mixed_reality_controller_SPEC_VERSION},
    {XR_EXT_LOCAL_FLOOR_EXTENSION_NAME, 1},
    {XR_EXT_PALM_POSE_EXTENSION_NAME, 3},
    {XR_EXT_SAMSUNG_ODYSSEY_CONTROLLER_EXTENSION_NAME, XR_EXT_samsung_odyssey_controller_SPEC_VERSION},
    {XR_EXT_USER_PRESENCE_EXTENSION_NAME, 1},
    {XR_EXT_UUID_EXTENSION_NAME, 1},
    {XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME, XR_FB_display_refresh_rate_SPEC_VERSION},
    {"XR_FB_touch_controller_pro", 1},
    {"XR_FB_touch_controller_proximity", 1},
    {XR_HTC_VIVE_COSMOS_CONTROLLER_INTERACTION_EXTENSION_NAME, XR_HTC_vive_cosmos_controller_interaction_SPEC_VERSION},
    {"XR_HTC_vive_focus3_controller_interaction", 2},
    {XR_KHR_BINDING_MODIFICATION_EXTENSION_NAME, XR_KHR_binding_modification_SPEC_VERSION},
    {XR_KHR_COMPOSITION_LAYER_COLOR_SCALE_BIAS_EXTENSION_NAME, XR_KHR_composition_layer_color_scale_bias_SPEC_VERSION},
    {XR_KHR_COMPOSITION_LAYER_CUBE_EXTENSION_NAME, XR_KHR_composition_layer_cube_SPEC_VERSION},
    {XR_KHR_COMPOSITION_LAYER_CYLINDER_EXTENSION_NAME, XR_KHR_composition_layer_cylinder_SPEC_VERSION},
    {XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME, XR_KHR_composition_layer_depth_SPEC_VERSION},
    {XR_KHR_COMPOSITION_LAYER_EQUIRECT2_EXTENSION_NAME, XR_KHR_composition_layer_equirect2_SPEC_VERSION},
    {XR_KHR_COMPOSITION_LAYER_EQUIRECT_EXTENSION_NAME, XR_KHR_composition_layer_equirect_SPEC_VERSION},
    {XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME, XR_KHR_convert_timespec_time_SPEC_VERSION},
    {XR_KHR_LOCATE_SPACES_EXTENSION_NAME, 1},
    {XR_KHR_MAINTENANCE1_EXTENSION_NAME, 1},
    {"XR_KHR_opengl_enable", 12},
    {XR_KHR_VISIBILITY_MASK_EXTENSION_NAME, XR_KHR_visibility_mask_SPEC_VERSION},
    {"XR_KHR_vulkan_enable", 8},
    {"XR_KHR_vulkan_enable2", 2},
    {"XR_META_touch_controller_plus", 1},
    {"XR_ML_ml2_controller_interaction", 1},
    {"XR_MNDX_egl_enable", 2},
    {XR_MND_HEADLESS_EXTENSION_NAME, XR_MND_headless_SPEC_VERSION},
    {XR_VARJO_QUAD_VIEWS_EXTENSION_NAME, XR_VARJO_quad_views_SPEC_VERSION},
};

}  // namespace

std::span<const Extension> extensions() { return offered; }

}  // namespace entoptic::runtime::api
