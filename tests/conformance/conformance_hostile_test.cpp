// labels: gpu
// Calls that make no sense: every function with null pointers, stale handles and structures of the wrong type gives a code, never a crash.
#include "runtime/testing/client.h"

#include <array>
#include <cstring>

namespace entoptic::runtime::testing {
namespace {

class Hostile : public SessionTest {};

template <class Handle> Handle bad_handle(std::uint64_t value) { return reinterpret_cast<Handle>(value); }

TEST_F(Hostile, HandlesOfAnotherType) {
    const auto as_space = reinterpret_cast<XrSpace>(session);
    const auto as_session = reinterpret_cast<XrSession>(xr.instance);
    EXPECT_EQ(xr.xrDestroySpace(as_space), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(xr.xrDestroySession(as_session), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(begin_session(), XR_SUCCESS) << "the session was not touched";
}

TEST_F(Hostile, NoHandleIsFollowed) {
    for (const std::uint64_t value :
         {std::uint64_t(0), std::uint64_t(1), std::uint64_t(0x1234), ~std::uint64_t(0), std::uint64_t(0x7fffffffffff)}) {
        const auto instance = bad_handle<XrInstance>(value);
        const auto bad_session = bad_handle<XrSession>(value);
        EXPECT_EQ(xr.xrDestroyInstance(instance), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrGetInstanceProperties(instance, nullptr), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrPollEvent(instance, nullptr), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrGetSystem(instance, nullptr, nullptr), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrGetSystemProperties(instance, 1, nullptr), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrCreateSession(instance, nullptr, nullptr), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrCreateActionSet(instance, nullptr, nullptr), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrStringToPath(instance, nullptr, nullptr), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrDestroySession(bad_session), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrBeginSession(bad_session, nullptr), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrEndSession(bad_session), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrRequestExitSession(bad_session), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrWaitFrame(bad_session, nullptr, nullptr), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrBeginFrame(bad_session, nullptr), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrEndFrame(bad_session, nullptr), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrSyncActions(bad_session, nullptr), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrLocateViews(bad_session, nullptr, nullptr, 0, nullptr, nullptr), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrDestroySwapchain(bad_handle<XrSwapchain>(value)), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrDestroySpace(bad_handle<XrSpace>(value)), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrDestroyAction(bad_handle<XrAction>(value)), XR_ERROR_HANDLE_INVALID);
        EXPECT_EQ(xr.xrDestroyActionSet(bad_handle<XrActionSet>(value)), XR_ERROR_HANDLE_INVALID);
    }
}

TEST_F(Hostile, NullPointersEverywhere) {
    EXPECT_EQ(xr.xrGetInstanceProperties(xr.instance, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrPollEvent(xr.instance, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrResultToString(xr.instance, XR_SUCCESS, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrStructureTypeToString(xr.instance, XR_TYPE_VIEW, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrGetSystem(xr.instance, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrGetSystemProperties(xr.instance, 1, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrEnumerateViewConfigurations(xr.instance, 1, 0, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrCreateSession(xr.instance, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrEnumerateReferenceSpaces(session, 0, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrCreateReferenceSpace(session, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrCreateActionSpace(session, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrEnumerateSwapchainFormats(session, 0, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrCreateSwapchain(session, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrLocateViews(session, nullptr, nullptr, 0, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrCreateActionSet(xr.instance, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrSuggestInteractionProfileBindings(xr.instance, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrAttachSessionActionSets(session, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrGetCurrentInteractionProfile(session, 1, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrGetActionStateBoolean(session, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrSyncActions(session, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrEnumerateBoundSourcesForAction(session, nullptr, 0, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrGetInputSourceLocalizedName(session, nullptr, 0, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrApplyHapticFeedback(session, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrStopHapticFeedback(session, nullptr), XR_ERROR_VALIDATION_FAILURE);
    const XrActionsSyncInfo sync{XR_TYPE_ACTIONS_SYNC_INFO, nullptr, 0xffffffff, nullptr};
    EXPECT_EQ(xr.xrSyncActions(session, &sync), XR_ERROR_VALIDATION_FAILURE);
    const XrSessionActionSetsAttachInfo attach{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, 0xffffffff, nullptr};
    EXPECT_EQ(xr.xrAttachSessionActionSets(session, &attach), XR_ERROR_VALIDATION_FAILURE);
}

TEST_F(Hostile, VulkanFunctions) {
    VkInstance instance = VK_NULL_HANDLE;
    VkResult result = VK_SUCCESS;
    const auto create = xr.get<PFN_xrCreateVulkanInstanceKHR>("xrCreateVulkanInstanceKHR");
    EXPECT_EQ(create(xr.instance, nullptr, &instance, &result), XR_ERROR_VALIDATION_FAILURE);
    XrVulkanInstanceCreateInfoKHR info{XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR, nullptr, 1, 0, nullptr, nullptr, nullptr};
    EXPECT_EQ(create(xr.instance, &info, &instance, &result), XR_ERROR_VALIDATION_FAILURE);
    info.pfnGetInstanceProcAddr = &vkGetInstanceProcAddr;
    EXPECT_EQ(create(xr.instance, &info, &instance, &result), XR_ERROR_VALIDATION_FAILURE);
    info.systemId = 9;
    EXPECT_EQ(create(xr.instance, &info, &instance, &result), XR_ERROR_SYSTEM_INVALID);
    const auto requirements = xr.get<PFN_xrGetVulkanGraphicsRequirements2KHR>("xrGetVulkanGraphicsRequirements2KHR");
    EXPECT_EQ(requirements(xr.instance, 1, nullptr), XR_ERROR_VALIDATION_FAILURE);
    // What the application's own vkCreateInstance says goes back to it.
    const char* names[] = {"VK_NO_such_extension"};
    VkInstanceCreateInfo vk_info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, nullptr, 0, nullptr, 0, nullptr, 1, names};
    info.systemId = 1;
    info.vulkanCreateInfo = &vk_info;
    EXPECT_EQ(create(xr.instance, &info, &instance, &result), XR_SUCCESS);
    EXPECT_EQ(result, VK_ERROR_EXTENSION_NOT_PRESENT);
}

TEST_F(Hostile, UntypedArraysAreRefusedUnlessTheApplicationsProfileSaysSo) {
    const auto garbage = [] {
        XrViewConfigurationView view;
        std::memset(static_cast<void*>(&view), 0x5a, sizeof view);
        return std::array{view, view};
    };
    constexpr auto stereo = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
    std::uint32_t count = 0;
    auto views = garbage();
    EXPECT_EQ(xr.xrEnumerateViewConfigurationViews(xr.instance, 1, stereo, 2, &count, views.data()), XR_ERROR_VALIDATION_FAILURE);
    xr.host->application_quirks.untyped_arrays = true;
    ASSERT_EQ(xr.xrEnumerateViewConfigurationViews(xr.instance, 1, stereo, 2, &count, views.data()), XR_SUCCESS);
    for (const XrViewConfigurationView& view : views) {
        EXPECT_EQ(view.type, XR_TYPE_VIEW_CONFIGURATION_VIEW);
        EXPECT_EQ(view.next, nullptr) << "what lay there is no chain";
        EXPECT_EQ(view.recommendedImageRectWidth, 256u);
    }
}

TEST_F(Hostile, EventsAreNotLostSilently) {
    // Nobody polls: the queue holds its capacity and says how many it dropped.
    for (int i = 0; i < 300; ++i) {
        EXPECT_EQ(xr.xrDestroySession(session), XR_SUCCESS);
        session = make_session();
    }
    EXPECT_EQ(xr.states(), (std::vector<XrSessionState>{XR_SESSION_STATE_IDLE, XR_SESSION_STATE_READY})) << "only the living session's";
}

}  // namespace
}  // namespace entoptic::runtime::testing
