// labels: gpu
// Sessions without graphics (XR_MND_headless).
#include "runtime/testing/client.h"

namespace entoptic::runtime::testing {
namespace {

XrResult create(Client& xr, const void* chain, XrSession& session) {
    const XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO, chain, 0, 1};
    return xr.xrCreateSession(xr.instance, &info, &session);
}

TEST(Headless, ReachesFocusWithoutAFrame) {
    Client xr(std::vector<const char*>{"XR_MND_headless"});
    XrSession session = XR_NULL_HANDLE;
    ASSERT_EQ(create(xr, nullptr, session), XR_SUCCESS);
    EXPECT_EQ(xr.states(), (std::vector{XR_SESSION_STATE_IDLE, XR_SESSION_STATE_READY}));
    const XrSessionBeginInfo begin{XR_TYPE_SESSION_BEGIN_INFO, nullptr, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};
    ASSERT_EQ(xr.xrBeginSession(session, &begin), XR_SUCCESS);
    EXPECT_EQ(xr.states(), (std::vector{XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_VISIBLE, XR_SESSION_STATE_FOCUSED}));
    // A frame loop, if there is one, works as any other; there is nothing to make swapchains of.
    XrFrameState state{XR_TYPE_FRAME_STATE};
    ASSERT_EQ(xr.xrWaitFrame(session, nullptr, &state), XR_SUCCESS);
    EXPECT_GT(state.predictedDisplayTime, 0);
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_SUCCESS);
    const XrFrameEndInfo end{XR_TYPE_FRAME_END_INFO, nullptr, state.predictedDisplayTime, XR_ENVIRONMENT_BLEND_MODE_OPAQUE, 0, nullptr};
    EXPECT_EQ(xr.xrEndFrame(session, &end), XR_SUCCESS);
    // Layers that such a loop brings name no swapchains: nothing is composed of them, and that is no error.
    ASSERT_EQ(xr.xrWaitFrame(session, nullptr, &state), XR_SUCCESS);
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_SUCCESS);
    const XrCompositionLayerProjection projection{XR_TYPE_COMPOSITION_LAYER_PROJECTION, nullptr, 0, XR_NULL_HANDLE, 0, nullptr};
    const auto* layer = reinterpret_cast<const XrCompositionLayerBaseHeader*>(&projection);
    const XrFrameEndInfo with_layer{XR_TYPE_FRAME_END_INFO, nullptr, state.predictedDisplayTime, XR_ENVIRONMENT_BLEND_MODE_OPAQUE, 1, &layer};
    EXPECT_EQ(xr.xrEndFrame(session, &with_layer), XR_SUCCESS);
    EXPECT_TRUE(xr.host->service.last_submission().layers.empty());
    std::uint32_t count = 9;
    EXPECT_EQ(xr.xrEnumerateSwapchainFormats(session, 0, &count, nullptr), XR_SUCCESS);
    EXPECT_EQ(count, 0u);
    const XrSwapchainCreateInfo info = SessionTest::swapchain_info();
    XrSwapchain swapchain = XR_NULL_HANDLE;
    EXPECT_EQ(xr.xrCreateSwapchain(session, &info, &swapchain), XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED);
    EXPECT_EQ(xr.xrRequestExitSession(session), XR_SUCCESS);
    EXPECT_EQ(xr.states().back(), XR_SESSION_STATE_STOPPING);
    EXPECT_EQ(xr.xrEndSession(session), XR_SUCCESS);
}

TEST(Headless, NotWithoutTheExtension) {
    Client xr(std::vector<const char*>{"XR_KHR_vulkan_enable2"});
    XrSession session = XR_NULL_HANDLE;
    EXPECT_EQ(create(xr, nullptr, session), XR_ERROR_GRAPHICS_DEVICE_INVALID);
}

}  // namespace
}  // namespace entoptic::runtime::testing
