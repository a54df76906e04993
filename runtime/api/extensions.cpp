#include "runtime/api/extensions.h"

namespace entoptic::runtime::api {

namespace {

// Names and revisions of the Vulkan extensions are spelled out: their macros need vulkan.h.
const Extension offered[] = {
    {"XR_KHR_vulkan_enable", 8},
    {"XR_KHR_vulkan_enable2", 2},
    {XR_EXT_DEBUG_UTILS_EXTENSION_NAME, XR_EXT_debug_utils_SPEC_VERSION},
    {XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME, XR_EXT_eye_gaze_interaction_SPEC_VERSION},
    {XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME, XR_KHR_composition_layer_depth_SPEC_VERSION},
    {XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME, XR_KHR_convert_timespec_time_SPEC_VERSION},
    {XR_ENTOPTICX_SCENE_LUMINANCE_EXTENSION_NAME, XR_ENTOPTICX_scene_luminance_SPEC_VERSION},
};

}  // namespace

std::span<const Extension> extensions() { return offered; }

}  // namespace entoptic::runtime::api
