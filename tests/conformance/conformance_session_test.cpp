// labels: gpu
// Session states and the events that tell them.
#include "runtime/testing/client.h"

namespace entoptic::runtime::testing {
namespace {

using States = std::vector<XrSessionState>;

class SessionStates : public SessionTest {};

TEST_F(SessionStates, FromIdleToFocusedAndBack) {
    EXPECT_EQ(xr.states(), (States{XR_SESSION_STATE_IDLE, XR_SESSION_STATE_READY}));
    ASSERT_EQ(begin_session(), XR_SUCCESS);
    EXPECT_EQ(xr.states(), States{}) << "nothing before the first frame";
    const XrFrameState first = wait_frame();
    EXPECT_EQ(first.shouldRender, XR_FALSE) << "not visible yet";
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_SUCCESS);
    EXPECT_EQ(end_frame(first.predictedDisplayTime), XR_SUCCESS);
    EXPECT_EQ(xr.states(), (States{XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_VISIBLE}));
    const XrFrameState second = wait_frame();
    EXPECT_EQ(second.shouldRender, XR_TRUE);
    EXPECT_GT(second.predictedDisplayTime, first.predictedDisplayTime);
    EXPECT_EQ(second.predictedDisplayPeriod, xr.host->service.period);
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_SUCCESS);
    EXPECT_EQ(end_frame(second.predictedDisplayTime), XR_SUCCESS);
    EXPECT_EQ(xr.states(), States{XR_SESSION_STATE_FOCUSED});

    EXPECT_EQ(xr.xrEndSession(session), XR_ERROR_SESSION_NOT_STOPPING);
    EXPECT_EQ(xr.xrRequestExitSession(session), XR_SUCCESS);
    EXPECT_EQ(xr.states(), (States{XR_SESSION_STATE_VISIBLE, XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_STOPPING}));
    EXPECT_EQ(frame(), XR_SUCCESS) << "the loop may go on until xrEndSession";
    EXPECT_EQ(xr.states(), States{});
    EXPECT_EQ(xr.xrEndSession(session), XR_SUCCESS);
    EXPECT_EQ(xr.states(), (States{XR_SESSION_STATE_IDLE, XR_SESSION_STATE_EXITING}));
    EXPECT_EQ(begin_session(), XR_ERROR_SESSION_NOT_READY);
    EXPECT_EQ(xr.host->service.sessions_begun, 1);
    EXPECT_EQ(xr.host->service.sessions_ended, 1);
}

TEST_F(SessionStates, CallsOutOfOrder) {
    EXPECT_EQ(xr.xrEndSession(session), XR_ERROR_SESSION_NOT_RUNNING);
    EXPECT_EQ(xr.xrRequestExitSession(session), XR_ERROR_SESSION_NOT_RUNNING);
    ASSERT_EQ(begin_session(), XR_SUCCESS);
    EXPECT_EQ(begin_session(), XR_ERROR_SESSION_RUNNING);
    EXPECT_EQ(xr.xrBeginSession(session, nullptr), XR_ERROR_VALIDATION_FAILURE);
    XrSessionBeginInfo info{XR_TYPE_SESSION_BEGIN_INFO, nullptr, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_MONO};
    EXPECT_EQ(xr.xrBeginSession(session, &info), XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED);
    info.primaryViewConfigurationType = XrViewConfigurationType(0);
    EXPECT_EQ(xr.xrBeginSession(session, &info), XR_ERROR_VALIDATION_FAILURE);
}

TEST_F(SessionStates, ExitBeforeAnyFrame) {
    ASSERT_EQ(begin_session(), XR_SUCCESS);
    static_cast<void>(xr.states());
    EXPECT_EQ(xr.xrRequestExitSession(session), XR_SUCCESS);
    EXPECT_EQ(xr.states(), (States{XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_STOPPING}));
    EXPECT_EQ(xr.xrEndSession(session), XR_SUCCESS);
    EXPECT_EQ(xr.states(), (States{XR_SESSION_STATE_IDLE, XR_SESSION_STATE_EXITING}));
}

TEST_F(SessionStates, TheHostMayEndTheSession) {
    run_to_focus();
    static_cast<void>(xr.states());
    xr.host->service.set_exit_after(5);
    EXPECT_EQ(frame(), XR_SUCCESS);
    EXPECT_EQ(xr.states(), States{});
    EXPECT_EQ(frame(), XR_SUCCESS);
    EXPECT_EQ(xr.states(), (States{XR_SESSION_STATE_VISIBLE, XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_STOPPING}));
    EXPECT_EQ(xr.xrEndSession(session), XR_SUCCESS);
    EXPECT_EQ(xr.states(), (States{XR_SESSION_STATE_IDLE, XR_SESSION_STATE_EXITING}));
}

TEST_F(SessionStates, LockstepRunsRepeatToTheNanosecond) {
    const auto run = [this] {
        std::vector<XrTime> times;
        Client& client = xr;
        EXPECT_EQ(begin_session(), XR_SUCCESS);
        for (int i = 0; i < 10; ++i) {
            const XrFrameState state = wait_frame();
            EXPECT_EQ(client.xrBeginFrame(session, nullptr), XR_SUCCESS);
            EXPECT_EQ(end_frame(state.predictedDisplayTime), XR_SUCCESS);
            times.push_back(state.predictedDisplayTime);
        }
        return times;
    };
    const auto times = run();
    for (std::size_t i = 1; i < times.size(); ++i) EXPECT_EQ(times[i] - times[i - 1], xr.host->service.period);
}

TEST_F(SessionStates, OneSessionAtATime) {
    const auto binding = vulkan.binding();
    const XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO, &binding, 0, 1};
    XrSession second = XR_NULL_HANDLE;
    EXPECT_EQ(xr.xrCreateSession(xr.instance, &info, &second), XR_ERROR_LIMIT_REACHED);
    ASSERT_EQ(begin_session(), XR_SUCCESS);
    EXPECT_EQ(xr.xrDestroySession(session), XR_SUCCESS);
    EXPECT_EQ(xr.host->service.sessions_ended, 1) << "a running session is ended";
    EXPECT_EQ(xr.states(), States{}) << "events of a destroyed session are dropped";
    EXPECT_EQ(xr.xrDestroySession(session), XR_ERROR_HANDLE_INVALID);
    session = make_session();
    EXPECT_EQ(begin_session(), XR_SUCCESS);
}

TEST_F(SessionStates, CreateSessionErrors) {
    auto binding = vulkan.binding();
    XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO, &binding, 0, 1};
    XrSession made = XR_NULL_HANDLE;
    const auto create = [&] { return xr.xrCreateSession(xr.instance, &info, &made); };
    info.systemId = XR_NULL_SYSTEM_ID;
    EXPECT_EQ(create(), XR_ERROR_SYSTEM_INVALID);
    info.systemId = 1;
    info.createFlags = 1;
    EXPECT_EQ(create(), XR_ERROR_VALIDATION_FAILURE);
    info.createFlags = 0;
    info.type = XR_TYPE_UNKNOWN;
    EXPECT_EQ(create(), XR_ERROR_VALIDATION_FAILURE);
    info.type = XR_TYPE_SESSION_CREATE_INFO;
    info.next = nullptr;
    EXPECT_EQ(create(), XR_ERROR_GRAPHICS_DEVICE_INVALID);
    info.next = &binding;
    binding.device = VK_NULL_HANDLE;
    EXPECT_EQ(create(), XR_ERROR_GRAPHICS_DEVICE_INVALID);
    binding = vulkan.binding();
    binding.queueFamilyIndex = 99;
    EXPECT_EQ(create(), XR_ERROR_GRAPHICS_DEVICE_INVALID);
    binding = vulkan.binding();
    binding.queueIndex = 99;
    EXPECT_EQ(create(), XR_ERROR_GRAPHICS_DEVICE_INVALID);
}

TEST(SessionGraphics, RequirementsMustBeAsked) {
    Client xr;
    VulkanApplication vulkan(xr, false);
    const auto binding = vulkan.binding();
    const XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO, &binding, 0, 1};
    XrSession session = XR_NULL_HANDLE;
    EXPECT_EQ(xr.xrCreateSession(xr.instance, &info, &session), XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING);
}

TEST(SessionGraphics, FirstVulkanExtension) {
    Client xr;
    VulkanApplication vulkan(xr);
    const auto list = [&](const char* name) {
        char text[512] = "";
        std::uint32_t count = 0;
        EXPECT_EQ(xr.get<PFN_xrGetVulkanInstanceExtensionsKHR>(name)(xr.instance, 1, sizeof(text), &count, text), XR_SUCCESS);
        EXPECT_EQ(count, std::strlen(text) + 1);
        return std::string(text);
    };
    EXPECT_NE(list("xrGetVulkanInstanceExtensionsKHR").find("VK_KHR_external_memory_capabilities"), std::string::npos);
    EXPECT_NE(list("xrGetVulkanDeviceExtensionsKHR").find("VK_KHR_external_memory_fd"), std::string::npos);
    VkPhysicalDevice device = VK_NULL_HANDLE;
    const auto get = xr.get<PFN_xrGetVulkanGraphicsDeviceKHR>("xrGetVulkanGraphicsDeviceKHR");
    EXPECT_EQ(get(xr.instance, 1, vulkan.instance, &device), XR_SUCCESS);
    EXPECT_EQ(device, vulkan.physical);
    EXPECT_EQ(get(xr.instance, 1, VK_NULL_HANDLE, &device), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(get(xr.instance, 7, vulkan.instance, &device), XR_ERROR_SYSTEM_INVALID);
}

TEST(SessionGraphics, LeakedSessionGoesWithTheInstance) {
    Client xr;
    VulkanApplication vulkan(xr);
    const auto binding = vulkan.binding();
    const XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO, &binding, 0, 1};
    XrSession session = XR_NULL_HANDLE;
    ASSERT_EQ(xr.xrCreateSession(xr.instance, &info, &session), XR_SUCCESS);
    const auto create_info = SessionTest::swapchain_info();
    XrSwapchain swapchain = XR_NULL_HANDLE;
    ASSERT_EQ(xr.xrCreateSwapchain(session, &create_info, &swapchain), XR_SUCCESS);
    const auto destroy = xr.xrDestroySession;
    EXPECT_EQ(xr.xrDestroyInstance(xr.instance), XR_SUCCESS);
    xr.instance = XR_NULL_HANDLE;
    EXPECT_EQ(destroy(session), XR_ERROR_HANDLE_INVALID);
}

}  // namespace
}  // namespace entoptic::runtime::testing
