// The system: one head-mounted display with two views.
#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/limits.h"
#include "runtime/api/verify.h"
#include "runtime/objects/views.h"

#include <algorithm>
#include <array>

namespace entoptic::runtime::api {

namespace {

constexpr std::array blend_modes{XR_ENVIRONMENT_BLEND_MODE_OPAQUE};

Outcome find_system(XrInstance handle, XrSystemId system, std::shared_ptr<Instance>& instance) {
    ENTOPTIC_XR_TRY(find(handle, instance));
    return check_system(system);
}

void fill_presence(Instance& instance, void* chain) {
    if (!instance.enabled(XR_EXT_USER_PRESENCE_EXTENSION_NAME)) return;
    auto* presence = chained<XrSystemUserPresencePropertiesEXT>(chain, XR_TYPE_SYSTEM_USER_PRESENCE_PROPERTIES_EXT);
    if (presence) presence->supportsUserPresence = instance.host().headset().presence ? XR_TRUE : XR_FALSE;
}

// No headset here sees hands: the extension is there so that applications can ask and be told so.
void fill_hand_tracking(Instance& instance, void* chain) {
    if (!instance.enabled(XR_EXT_HAND_TRACKING_EXTENSION_NAME)) return;
    auto* hands = chained<XrSystemHandTrackingPropertiesEXT>(chain, XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT);
    if (hands) hands->supportsHandTracking = XR_FALSE;
}

}  // namespace

XrResult XRAPI_CALL get_system(XrInstance handle, const XrSystemGetInfo* info, XrSystemId* system) {
    return call("xrGetSystem", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_SYSTEM_GET_INFO, "getInfo"));
        ENTOPTIC_XR_TRY(require_pointer(system, "systemId"));
        if (info->formFactor != XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY) {
            return error(XR_ERROR_FORM_FACTOR_UNSUPPORTED, "only XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY is offered");
        }
        *system = headset_system;
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL get_system_properties(XrInstance handle, XrSystemId system, XrSystemProperties* properties) {
    return call("xrGetSystemProperties", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find_system(handle, system, instance));
        ENTOPTIC_XR_TRY(require(properties, XR_TYPE_SYSTEM_PROPERTIES, "properties"));
        Headset& headset = instance->host().headset();
        properties->systemId = system;
        properties->vendorId = 0;
        std::memset(properties->systemName, 0, sizeof(properties->systemName));
        std::strncpy(properties->systemName, headset.display.name.c_str(), sizeof(properties->systemName) - 1);
        properties->graphicsProperties = {largest_swapchain_side, largest_swapchain_side, max_layers};
        properties->trackingProperties = {XR_TRUE, XR_TRUE};
        fill_presence(*instance, properties->next);
        fill_hand_tracking(*instance, properties->next);
        auto* gaze = chained<XrSystemEyeGazeInteractionPropertiesEXT>(properties->next, XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT);
        if (gaze && instance->enabled(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME)) {
            gaze->supportsEyeGazeInteraction = headset.eye_tracker && headset.eye_tracker->present() ? XR_TRUE : XR_FALSE;
        }
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL enumerate_environment_blend_modes(XrInstance handle, XrSystemId system, XrViewConfigurationType type, uint32_t capacity,
                                                      uint32_t* count, XrEnvironmentBlendMode* modes) {
    return call("xrEnumerateEnvironmentBlendModes", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find_system(handle, system, instance));
        ENTOPTIC_XR_TRY(check_view_configuration(*instance, type));
        return two_call_values(capacity, count, modes, blend_modes);
    });
}

XrResult XRAPI_CALL enumerate_view_configurations(XrInstance handle, XrSystemId system, uint32_t capacity, uint32_t* count,
                                                  XrViewConfigurationType* types) {
    return call("xrEnumerateViewConfigurations", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find_system(handle, system, instance));
        return two_call_values(capacity, count, types, view_configurations(instance->features()));
    });
}

XrResult XRAPI_CALL get_view_configuration_properties(XrInstance handle, XrSystemId system, XrViewConfigurationType type,
                                                      XrViewConfigurationProperties* properties) {
    return call("xrGetViewConfigurationProperties", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find_system(handle, system, instance));
        ENTOPTIC_XR_TRY(require(properties, XR_TYPE_VIEW_CONFIGURATION_PROPERTIES, "configurationProperties"));
        ENTOPTIC_XR_TRY(check_view_configuration(*instance, type));
        properties->viewConfigurationType = type;
        properties->fovMutable = XR_TRUE;  // each layer's own fov is used
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL enumerate_view_configuration_views(XrInstance handle, XrSystemId system, XrViewConfigurationType type,
                                                       uint32_t capacity, uint32_t* count, XrViewConfigurationView* views) {
    return call("xrEnumerateViewConfigurationViews", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find_system(handle, system, instance));
        ENTOPTIC_XR_TRY(check_view_configuration(*instance, type));
        bool fill = false;
        const std::size_t view_total = view_count(type);
        ENTOPTIC_XR_TRY(two_call(capacity, count, views, view_total, fill));
        if (!fill) return XR_SUCCESS;
        for (std::size_t i = 0; i < view_total; ++i) ENTOPTIC_XR_TRY(require_element(*instance, views[i], XR_TYPE_VIEW_CONFIGURATION_VIEW, "views"));
        for (std::size_t i = 0; i < view_total; ++i) {
            const ViewSize size = recommended_view_size(instance->host(), type, i, instance->host().headset());
            views[i].recommendedImageRectWidth = size.width;
            views[i].recommendedImageRectHeight = size.height;
            views[i].maxImageRectWidth = std::max(size.width, largest_view_side);
            views[i].maxImageRectHeight = std::max(size.height, largest_view_side);
            views[i].recommendedSwapchainSampleCount = views[i].maxSwapchainSampleCount = 1;
        }
        return XR_SUCCESS;
    });
}

}  // namespace entoptic::runtime::api
