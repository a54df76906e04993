// Every function of the C ABI but the Vulkan ones (runtime/graphics/vulkan_functions.h), named after the specification's: xrWaitFrame is
// wait_frame. Their contracts are the specification's; the table that leads here is in api/proc_table.cpp.
#pragma once

#include "entoptic/XR_ENTOPTICX_observer.h"
#include "entoptic/XR_ENTOPTICX_presentation_timing.h"
#include "runtime/openxr.h"

namespace entoptic::runtime::api {

XrResult XRAPI_CALL enumerate_api_layer_properties(uint32_t propertyCapacityInput, uint32_t* propertyCountOutput,
                                                   XrApiLayerProperties* properties);
XrResult XRAPI_CALL enumerate_instance_extension_properties(const char* layerName, uint32_t propertyCapacityInput,
                                                            uint32_t* propertyCountOutput, XrExtensionProperties* properties);
XrResult XRAPI_CALL create_instance(const XrInstanceCreateInfo* createInfo, XrInstance* instance);
XrResult XRAPI_CALL destroy_instance(XrInstance instance);
XrResult XRAPI_CALL get_instance_properties(XrInstance instance, XrInstanceProperties* instanceProperties);
XrResult XRAPI_CALL poll_event(XrInstance instance, XrEventDataBuffer* eventData);
XrResult XRAPI_CALL result_to_string(XrInstance instance, XrResult value, char buffer[XR_MAX_RESULT_STRING_SIZE]);
XrResult XRAPI_CALL structure_type_to_string(XrInstance instance, XrStructureType value, char buffer[XR_MAX_STRUCTURE_NAME_SIZE]);
XrResult XRAPI_CALL get_system(XrInstance instance, const XrSystemGetInfo* getInfo, XrSystemId* systemId);
XrResult XRAPI_CALL get_system_properties(XrInstance instance, XrSystemId systemId, XrSystemProperties* properties);
XrResult XRAPI_CALL enumerate_environment_blend_modes(XrInstance instance, XrSystemId systemId,
                                                      XrViewConfigurationType viewConfigurationType,
                                                      uint32_t environmentBlendModeCapacityInput, uint32_t* environmentBlendModeCountOutput,
                                                      XrEnvironmentBlendMode* environmentBlendModes);
XrResult XRAPI_CALL create_session(XrInstance instance, const XrSessionCreateInfo* createInfo, XrSession* session);
XrResult XRAPI_CALL destroy_session(XrSession session);
XrResult XRAPI_CALL enumerate_reference_spaces(XrSession session, uint32_t spaceCapacityInput, uint32_t* spaceCountOutput,
                                               XrReferenceSpaceType* spaces);
XrResult XRAPI_CALL create_reference_space(XrSession session, const XrReferenceSpaceCreateInfo* createInfo, XrSpace* space);
XrResult XRAPI_CALL get_reference_space_bounds_rect(XrSession session, XrReferenceSpaceType referenceSpaceType, XrExtent2Df* bounds);
XrResult XRAPI_CALL create_action_space(XrSession session, const XrActionSpaceCreateInfo* createInfo, XrSpace* space);
XrResult XRAPI_CALL locate_space(XrSpace space, XrSpace baseSpace, XrTime time, XrSpaceLocation* location);
XrResult XRAPI_CALL destroy_space(XrSpace space);
XrResult XRAPI_CALL enumerate_view_configurations(XrInstance instance, XrSystemId systemId, uint32_t viewConfigurationTypeCapacityInput,
                                                  uint32_t* viewConfigurationTypeCountOutput,
                                                  XrViewConfigurationType* viewConfigurationTypes);
XrResult XRAPI_CALL get_view_configuration_properties(XrInstance instance, XrSystemId systemId,
                                                      XrViewConfigurationType viewConfigurationType,
                                                      XrViewConfigurationProperties* configurationProperties);
XrResult XRAPI_CALL enumerate_view_configuration_views(XrInstance instance, XrSystemId systemId,
                                                       XrViewConfigurationType viewConfigurationType, uint32_t viewCapacityInput,
                                                       uint32_t* viewCountOutput, XrViewConfigurationView* views);
XrResult XRAPI_CALL enumerate_swapchain_formats(XrSession session, uint32_t formatCapacityInput, uint32_t* formatCountOutput,
                                                int64_t* formats);
XrResult XRAPI_CALL create_swapchain(XrSession session, const XrSwapchainCreateInfo* createInfo, XrSwapchain* swapchain);
XrResult XRAPI_CALL destroy_swapchain(XrSwapchain swapchain);
XrResult XRAPI_CALL enumerate_swapchain_images(XrSwapchain swapchain, uint32_t imageCapacityInput, uint32_t* imageCountOutput,
                                               XrSwapchainImageBaseHeader* images);
XrResult XRAPI_CALL acquire_swapchain_image(XrSwapchain swapchain, const XrSwapchainImageAcquireInfo* acquireInfo, uint32_t* index);
XrResult XRAPI_CALL wait_swapchain_image(XrSwapchain swapchain, const XrSwapchainImageWaitInfo* waitInfo);
XrResult XRAPI_CALL release_swapchain_image(XrSwapchain swapchain, const XrSwapchainImageReleaseInfo* releaseInfo);
XrResult XRAPI_CALL begin_session(XrSession session, const XrSessionBeginInfo* beginInfo);
XrResult XRAPI_CALL end_session(XrSession session);
XrResult XRAPI_CALL request_exit_session(XrSession session);
XrResult XRAPI_CALL wait_frame(XrSession session, const XrFrameWaitInfo* frameWaitInfo, XrFrameState* frameState);
XrResult XRAPI_CALL begin_frame(XrSession session, const XrFrameBeginInfo* frameBeginInfo);
XrResult XRAPI_CALL end_frame(XrSession session, const XrFrameEndInfo* frameEndInfo);
XrResult XRAPI_CALL locate_views(XrSession session, const XrViewLocateInfo* viewLocateInfo, XrViewState* viewState,
                                 uint32_t viewCapacityInput, uint32_t* viewCountOutput, XrView* views);
XrResult XRAPI_CALL string_to_path(XrInstance instance, const char* pathString, XrPath* path);
XrResult XRAPI_CALL path_to_string(XrInstance instance, XrPath path, uint32_t bufferCapacityInput, uint32_t* bufferCountOutput,
                                   char* buffer);
XrResult XRAPI_CALL create_action_set(XrInstance instance, const XrActionSetCreateInfo* createInfo, XrActionSet* actionSet);
XrResult XRAPI_CALL destroy_action_set(XrActionSet actionSet);
XrResult XRAPI_CALL create_action(XrActionSet actionSet, const XrActionCreateInfo* createInfo, XrAction* action);
XrResult XRAPI_CALL destroy_action(XrAction action);
XrResult XRAPI_CALL suggest_interaction_profile_bindings(XrInstance instance,
                                                         const XrInteractionProfileSuggestedBinding* suggestedBindings);
XrResult XRAPI_CALL attach_session_action_sets(XrSession session, const XrSessionActionSetsAttachInfo* attachInfo);
XrResult XRAPI_CALL get_current_interaction_profile(XrSession session, XrPath topLevelUserPath,
                                                    XrInteractionProfileState* interactionProfile);
XrResult XRAPI_CALL get_action_state_boolean(XrSession session, const XrActionStateGetInfo* getInfo, XrActionStateBoolean* state);
XrResult XRAPI_CALL get_action_state_float(XrSession session, const XrActionStateGetInfo* getInfo, XrActionStateFloat* state);
XrResult XRAPI_CALL get_action_state_vector2f(XrSession session, const XrActionStateGetInfo* getInfo, XrActionStateVector2f* state);
XrResult XRAPI_CALL get_action_state_pose(XrSession session, const XrActionStateGetInfo* getInfo, XrActionStatePose* state);
XrResult XRAPI_CALL sync_actions(XrSession session, const XrActionsSyncInfo* syncInfo);
XrResult XRAPI_CALL enumerate_bound_sources_for_action(XrSession session, const XrBoundSourcesForActionEnumerateInfo* enumerateInfo,
                                                       uint32_t sourceCapacityInput, uint32_t* sourceCountOutput, XrPath* sources);
XrResult XRAPI_CALL get_input_source_localized_name(XrSession session, const XrInputSourceLocalizedNameGetInfo* getInfo,
                                                    uint32_t bufferCapacityInput, uint32_t* bufferCountOutput, char* buffer);
XrResult XRAPI_CALL apply_haptic_feedback(XrSession session, const XrHapticActionInfo* hapticActionInfo,
                                          const XrHapticBaseHeader* hapticFeedback);
XrResult XRAPI_CALL stop_haptic_feedback(XrSession session, const XrHapticActionInfo* hapticActionInfo);

// XR_EXT_debug_utils
XrResult XRAPI_CALL set_debug_utils_object_name(XrInstance instance, const XrDebugUtilsObjectNameInfoEXT* nameInfo);
XrResult XRAPI_CALL create_debug_utils_messenger(XrInstance instance, const XrDebugUtilsMessengerCreateInfoEXT* createInfo,
                                                 XrDebugUtilsMessengerEXT* messenger);
XrResult XRAPI_CALL destroy_debug_utils_messenger(XrDebugUtilsMessengerEXT messenger);
XrResult XRAPI_CALL submit_debug_utils_message(XrInstance instance, XrDebugUtilsMessageSeverityFlagsEXT messageSeverity,
                                               XrDebugUtilsMessageTypeFlagsEXT messageTypes,
                                               const XrDebugUtilsMessengerCallbackDataEXT* callbackData);
XrResult XRAPI_CALL session_begin_debug_utils_label_region(XrSession session, const XrDebugUtilsLabelEXT* labelInfo);
XrResult XRAPI_CALL session_end_debug_utils_label_region(XrSession session);
XrResult XRAPI_CALL session_insert_debug_utils_label(XrSession session, const XrDebugUtilsLabelEXT* labelInfo);

// XR_ENTOPTICX_observer
XrResult XRAPI_CALL get_observer(XrSession session, const XrObserverGetInfoENTOPTICX* getInfo, XrObserverENTOPTICX* observer);

// XR_ENTOPTICX_presentation_timing
XrResult XRAPI_CALL enumerate_presentation_timings(XrSession session, const XrPresentationTimingGetInfoENTOPTICX* getInfo,
                                                   uint32_t timingCapacityInput, uint32_t* timingCountOutput,
                                                   XrPresentationTimingENTOPTICX* timings);

// OpenXR 1.1, XR_KHR_locate_spaces
XrResult XRAPI_CALL locate_spaces(XrSession session, const XrSpacesLocateInfo* locateInfo, XrSpaceLocations* spaceLocations);

// XR_EXT_conformance_automation
XrResult XRAPI_CALL set_input_device_active(XrSession session, XrPath interactionProfile, XrPath topLevelPath, XrBool32 isActive);
XrResult XRAPI_CALL set_input_device_state_bool(XrSession session, XrPath topLevelPath, XrPath inputSourcePath, XrBool32 state);
XrResult XRAPI_CALL set_input_device_state_float(XrSession session, XrPath topLevelPath, XrPath inputSourcePath, float state);
XrResult XRAPI_CALL set_input_device_state_vector2f(XrSession session, XrPath topLevelPath, XrPath inputSourcePath, XrVector2f state);
XrResult XRAPI_CALL set_input_device_location(XrSession session, XrPath topLevelPath, XrPath inputSourcePath, XrSpace space, XrPosef pose);

// XR_EXT_hand_tracking
XrResult XRAPI_CALL create_hand_tracker(XrSession session, const XrHandTrackerCreateInfoEXT* createInfo, XrHandTrackerEXT* handTracker);
XrResult XRAPI_CALL destroy_hand_tracker(XrHandTrackerEXT handTracker);
XrResult XRAPI_CALL locate_hand_joints(XrHandTrackerEXT handTracker, const XrHandJointsLocateInfoEXT* locateInfo,
                                       XrHandJointLocationsEXT* locations);

// XR_FB_display_refresh_rate
XrResult XRAPI_CALL enumerate_display_refresh_rates(XrSession session, uint32_t displayRefreshRateCapacityInput,
                                                    uint32_t* displayRefreshRateCountOutput, float* displayRefreshRates);
XrResult XRAPI_CALL get_display_refresh_rate(XrSession session, float* displayRefreshRate);
XrResult XRAPI_CALL request_display_refresh_rate(XrSession session, float displayRefreshRate);

// XR_KHR_visibility_mask
XrResult XRAPI_CALL get_visibility_mask(XrSession session, XrViewConfigurationType viewConfigurationType, uint32_t viewIndex,
                                        XrVisibilityMaskTypeKHR visibilityMaskType, XrVisibilityMaskKHR* visibilityMask);

// XR_KHR_convert_timespec_time
XrResult XRAPI_CALL convert_timespec_time_to_time(XrInstance instance, const struct timespec* timespecTime, XrTime* time);
XrResult XRAPI_CALL convert_time_to_timespec_time(XrInstance instance, XrTime time, struct timespec* timespecTime);

}  // namespace entoptic::runtime::api
