// The one table of everything xrGetInstanceProcAddr can give, and the function itself.
#include "runtime/api/call.h"
#include "runtime/api/extensions.h"
#include "runtime/api/functions.h"
#include "runtime/api/verify.h"
#include "runtime/graphics/bindings.h"
#include "runtime/runtime.h"

#include <string_view>

namespace entoptic::runtime {

namespace {

struct Entry {
    std::string_view name;
    const char* extension;  // null: core
    PFN_xrVoidFunction function;
    Features needs = 0;
};

// The template argument makes the compiler compare the signature with the specification's.
template <class Function> Entry entry(std::string_view name, const char* extension, Function function) {
    return {name, extension, reinterpret_cast<PFN_xrVoidFunction>(function)};
}

// A function of OpenXR 1.1, for applications that asked for it.
template <class Function> Entry core_1_1(std::string_view name, Function function) {
    return {name, nullptr, reinterpret_cast<PFN_xrVoidFunction>(function), feature_1_1};
}

constexpr const char* debug_utils = XR_EXT_DEBUG_UTILS_EXTENSION_NAME;
constexpr const char* automation = XR_EXT_CONFORMANCE_AUTOMATION_EXTENSION_NAME;
constexpr const char* hand_tracking = XR_EXT_HAND_TRACKING_EXTENSION_NAME;
constexpr const char* refresh_rate = XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME;
constexpr const char* visibility_mask = XR_KHR_VISIBILITY_MASK_EXTENSION_NAME;
constexpr const char* timespec_time = XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME;

const Entry table[] = {
    entry<PFN_xrGetInstanceProcAddr>("xrGetInstanceProcAddr", nullptr, get_instance_proc_addr),
    entry<PFN_xrEnumerateApiLayerProperties>("xrEnumerateApiLayerProperties", nullptr, api::enumerate_api_layer_properties),
    entry<PFN_xrEnumerateInstanceExtensionProperties>("xrEnumerateInstanceExtensionProperties", nullptr,
                                                      api::enumerate_instance_extension_properties),
    entry<PFN_xrCreateInstance>("xrCreateInstance", nullptr, api::create_instance),
    entry<PFN_xrDestroyInstance>("xrDestroyInstance", nullptr, api::destroy_instance),
    entry<PFN_xrGetInstanceProperties>("xrGetInstanceProperties", nullptr, api::get_instance_properties),
    entry<PFN_xrPollEvent>("xrPollEvent", nullptr, api::poll_event),
    entry<PFN_xrResultToString>("xrResultToString", nullptr, api::result_to_string),
    entry<PFN_xrStructureTypeToString>("xrStructureTypeToString", nullptr, api::structure_type_to_string),
    entry<PFN_xrGetSystem>("xrGetSystem", nullptr, api::get_system),
    entry<PFN_xrGetSystemProperties>("xrGetSystemProperties", nullptr, api::get_system_properties),
    entry<PFN_xrEnumerateEnvironmentBlendModes>("xrEnumerateEnvironmentBlendModes", nullptr, api::enumerate_environment_blend_modes),
    entry<PFN_xrCreateSession>("xrCreateSession", nullptr, api::create_session),
    entry<PFN_xrDestroySession>("xrDestroySession", nullptr, api::destroy_session),
    entry<PFN_xrEnumerateReferenceSpaces>("xrEnumerateReferenceSpaces", nullptr, api::enumerate_reference_spaces),
    entry<PFN_xrCreateReferenceSpace>("xrCreateReferenceSpace", nullptr, api::create_reference_space),
    entry<PFN_xrGetReferenceSpaceBoundsRect>("xrGetReferenceSpaceBoundsRect", nullptr, api::get_reference_space_bounds_rect),
    entry<PFN_xrCreateActionSpace>("xrCreateActionSpace", nullptr, api::create_action_space),
    entry<PFN_xrLocateSpace>("xrLocateSpace", nullptr, api::locate_space),
    entry<PFN_xrDestroySpace>("xrDestroySpace", nullptr, api::destroy_space),
    entry<PFN_xrEnumerateViewConfigurations>("xrEnumerateViewConfigurations", nullptr, api::enumerate_view_configurations),
    entry<PFN_xrGetViewConfigurationProperties>("xrGetViewConfigurationProperties", nullptr, api::get_view_configuration_properties),
    entry<PFN_xrEnumerateViewConfigurationViews>("xrEnumerateViewConfigurationViews", nullptr, api::enumerate_view_configuration_views),
    entry<PFN_xrEnumerateSwapchainFormats>("xrEnumerateSwapchainFormats", nullptr, api::enumerate_swapchain_formats),
    entry<PFN_xrCreateSwapchain>("xrCreateSwapchain", nullptr, api::create_swapchain),
    entry<PFN_xrDestroySwapchain>("xrDestroySwapchain", nullptr, api::destroy_swapchain),
    entry<PFN_xrEnumerateSwapchainImages>("xrEnumerateSwapchainImages", nullptr, api::enumerate_swapchain_images),
    entry<PFN_xrAcquireSwapchainImage>("xrAcquireSwapchainImage", nullptr, api::acquire_swapchain_image),
    entry<PFN_xrWaitSwapchainImage>("xrWaitSwapchainImage", nullptr, api::wait_swapchain_image),
    entry<PFN_xrReleaseSwapchainImage>("xrReleaseSwapchainImage", nullptr, api::release_swapchain_image),
    entry<PFN_xrBeginSession>("xrBeginSession", nullptr, api::begin_session),
    entry<PFN_xrEndSession>("xrEndSession", nullptr, api::end_session),
    entry<PFN_xrRequestExitSession>("xrRequestExitSession", nullptr, api::request_exit_session),
    entry<PFN_xrWaitFrame>("xrWaitFrame", nullptr, api::wait_frame),
    entry<PFN_xrBeginFrame>("xrBeginFrame", nullptr, api::begin_frame),
    entry<PFN_xrEndFrame>("xrEndFrame", nullptr, api::end_frame),
    entry<PFN_xrLocateViews>("xrLocateViews", nullptr, api::locate_views),
    entry<PFN_xrStringToPath>("xrStringToPath", nullptr, api::string_to_path),
    entry<PFN_xrPathToString>("xrPathToString", nullptr, api::path_to_string),
    entry<PFN_xrCreateActionSet>("xrCreateActionSet", nullptr, api::create_action_set),
    entry<PFN_xrDestroyActionSet>("xrDestroyActionSet", nullptr, api::destroy_action_set),
    entry<PFN_xrCreateAction>("xrCreateAction", nullptr, api::create_action),
    entry<PFN_xrDestroyAction>("xrDestroyAction", nullptr, api::destroy_action),
    entry<PFN_xrSuggestInteractionProfileBindings>("xrSuggestInteractionProfileBindings", nullptr,
                                                   api::suggest_interaction_profile_bindings),
    entry<PFN_xrAttachSessionActionSets>("xrAttachSessionActionSets", nullptr, api::attach_session_action_sets),
    entry<PFN_xrGetCurrentInteractionProfile>("xrGetCurrentInteractionProfile", nullptr, api::get_current_interaction_profile),
    entry<PFN_xrGetActionStateBoolean>("xrGetActionStateBoolean", nullptr, api::get_action_state_boolean),
    entry<PFN_xrGetActionStateFloat>("xrGetActionStateFloat", nullptr, api::get_action_state_float),
    entry<PFN_xrGetActionStateVector2f>("xrGetActionStateVector2f", nullptr, api::get_action_state_vector2f),
    entry<PFN_xrGetActionStatePose>("xrGetActionStatePose", nullptr, api::get_action_state_pose),
    entry<PFN_xrSyncActions>("xrSyncActions", nullptr, api::sync_actions),
    entry<PFN_xrEnumerateBoundSourcesForAction>("xrEnumerateBoundSourcesForAction", nullptr, api::enumerate_bound_sources_for_action),
    entry<PFN_xrGetInputSourceLocalizedName>("xrGetInputSourceLocalizedName", nullptr, api::get_input_source_localized_name),
    entry<PFN_xrApplyHapticFeedback>("xrApplyHapticFeedback", nullptr, api::apply_haptic_feedback),
    entry<PFN_xrStopHapticFeedback>("xrStopHapticFeedback", nullptr, api::stop_haptic_feedback),
    entry<PFN_xrGetObserverENTOPTICX>("xrGetObserverENTOPTICX", XR_ENTOPTICX_OBSERVER_EXTENSION_NAME, api::get_observer),
    entry<PFN_xrEnumeratePresentationTimingsENTOPTICX>(
        "xrEnumeratePresentationTimingsENTOPTICX", XR_ENTOPTICX_PRESENTATION_TIMING_EXTENSION_NAME, api::enumerate_presentation_timings),
    core_1_1<PFN_xrLocateSpaces>("xrLocateSpaces", api::locate_spaces),
    entry<PFN_xrLocateSpaces>("xrLocateSpacesKHR", XR_KHR_LOCATE_SPACES_EXTENSION_NAME, api::locate_spaces),
    entry<PFN_xrSetInputDeviceActiveEXT>("xrSetInputDeviceActiveEXT", automation, api::set_input_device_active),
    entry<PFN_xrSetInputDeviceStateBoolEXT>("xrSetInputDeviceStateBoolEXT", automation, api::set_input_device_state_bool),
    entry<PFN_xrSetInputDeviceStateFloatEXT>("xrSetInputDeviceStateFloatEXT", automation, api::set_input_device_state_float),
    entry<PFN_xrSetInputDeviceStateVector2fEXT>("xrSetInputDeviceStateVector2fEXT", automation, api::set_input_device_state_vector2f),
    entry<PFN_xrSetInputDeviceLocationEXT>("xrSetInputDeviceLocationEXT", automation, api::set_input_device_location),
    entry<PFN_xrCreateHandTrackerEXT>("xrCreateHandTrackerEXT", hand_tracking, api::create_hand_tracker),
    entry<PFN_xrDestroyHandTrackerEXT>("xrDestroyHandTrackerEXT", hand_tracking, api::destroy_hand_tracker),
    entry<PFN_xrLocateHandJointsEXT>("xrLocateHandJointsEXT", hand_tracking, api::locate_hand_joints),
    entry<PFN_xrEnumerateDisplayRefreshRatesFB>("xrEnumerateDisplayRefreshRatesFB", refresh_rate, api::enumerate_display_refresh_rates),
    entry<PFN_xrGetDisplayRefreshRateFB>("xrGetDisplayRefreshRateFB", refresh_rate, api::get_display_refresh_rate),
    entry<PFN_xrRequestDisplayRefreshRateFB>("xrRequestDisplayRefreshRateFB", refresh_rate, api::request_display_refresh_rate),
    entry<PFN_xrGetVisibilityMaskKHR>("xrGetVisibilityMaskKHR", visibility_mask, api::get_visibility_mask),
    entry<PFN_xrSetDebugUtilsObjectNameEXT>("xrSetDebugUtilsObjectNameEXT", debug_utils, api::set_debug_utils_object_name),
    entry<PFN_xrCreateDebugUtilsMessengerEXT>("xrCreateDebugUtilsMessengerEXT", debug_utils, api::create_debug_utils_messenger),
    entry<PFN_xrDestroyDebugUtilsMessengerEXT>("xrDestroyDebugUtilsMessengerEXT", debug_utils, api::destroy_debug_utils_messenger),
    entry<PFN_xrSubmitDebugUtilsMessageEXT>("xrSubmitDebugUtilsMessageEXT", debug_utils, api::submit_debug_utils_message),
    entry<PFN_xrSessionBeginDebugUtilsLabelRegionEXT>("xrSessionBeginDebugUtilsLabelRegionEXT", debug_utils,
                                                      api::session_begin_debug_utils_label_region),
    entry<PFN_xrSessionEndDebugUtilsLabelRegionEXT>("xrSessionEndDebugUtilsLabelRegionEXT", debug_utils,
                                                    api::session_end_debug_utils_label_region),
    entry<PFN_xrSessionInsertDebugUtilsLabelEXT>("xrSessionInsertDebugUtilsLabelEXT", debug_utils, api::session_insert_debug_utils_label),
    entry<PFN_xrConvertTimespecTimeToTimeKHR>("xrConvertTimespecTimeToTimeKHR", timespec_time, api::convert_timespec_time_to_time),
    entry<PFN_xrConvertTimeToTimespecTimeKHR>("xrConvertTimeToTimespecTimeKHR", timespec_time, api::convert_time_to_timespec_time),
};

bool without_instance(std::string_view name) {
    return name == "xrGetInstanceProcAddr" || name == "xrEnumerateApiLayerProperties" || name == "xrEnumerateInstanceExtensionProperties" ||
           name == "xrCreateInstance";
}

bool offered(const Entry& entry, const Instance& instance) {
    return instance.has(entry.needs) && (!entry.extension || instance.enabled(entry.extension));
}

Outcome look_up(XrInstance handle, std::string_view name, PFN_xrVoidFunction* function) {
    std::shared_ptr<Instance> instance;
    if (handle == XR_NULL_HANDLE) {
        if (!without_instance(name)) return error(XR_ERROR_HANDLE_INVALID, "{} needs an instance", name);
    } else {
        ENTOPTIC_XR_TRY(api::find(handle, instance));
    }
    for (const Entry& entry : table) {
        if (entry.name == name && (!instance || offered(entry, *instance))) {
            *function = entry.function;
            return XR_SUCCESS;
        }
    }
    const graphics::FunctionEntry* graphics = graphics::find_function(name);
    if (graphics && instance && instance->enabled(graphics->extension)) {
        *function = graphics->function;
        return XR_SUCCESS;
    }
    return error(XR_ERROR_FUNCTION_UNSUPPORTED, "{} is not a function of the application's version of OpenXR or of an enabled extension",
                 name);
}

}  // namespace

XrResult XRAPI_CALL get_instance_proc_addr(XrInstance instance, const char* name, PFN_xrVoidFunction* function) {
    return api::call("xrGetInstanceProcAddr", instance, [&]() -> Outcome {
        ENTOPTIC_XR_TRY(api::require_pointer(function, "function"));
        *function = nullptr;
        ENTOPTIC_XR_TRY(api::require_pointer(name, "name"));
        return look_up(instance, name, function);
    });
}

}  // namespace entoptic::runtime
