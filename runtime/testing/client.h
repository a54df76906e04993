// An OpenXR client for tests: negotiates as the loader does, and reaches every function through xrGetInstanceProcAddr. Header-only.
#pragma once

#include <vulkan/vulkan_core.h>

#define XR_USE_GRAPHICS_API_VULKAN
#include "runtime/openxr.h"

#include "runtime/runtime.h"
#include "runtime/testing/fake_host.h"

#include <gtest/gtest.h>

#include <cstring>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#define ENTOPTIC_CORE_FUNCTIONS(X)                                                                                                         \
    X(xrEnumerateApiLayerProperties)                                                                                                       \
    X(xrEnumerateInstanceExtensionProperties)                                                                                              \
    X(xrCreateInstance)                                                                                                                    \
    X(xrDestroyInstance)                                                                                                                   \
    X(xrGetInstanceProperties)                                                                                                             \
    X(xrPollEvent) X(xrResultToString) X(xrStructureTypeToString) X(xrGetSystem) X(xrGetSystemProperties)                                  \
        X(xrEnumerateEnvironmentBlendModes) X(xrCreateSession) X(xrDestroySession) X(xrEnumerateReferenceSpaces) X(xrCreateReferenceSpace) \
            X(xrGetReferenceSpaceBoundsRect) X(xrCreateActionSpace) X(xrLocateSpace) X(xrDestroySpace) X(xrEnumerateViewConfigurations)    \
                X(xrGetViewConfigurationProperties) X(xrEnumerateViewConfigurationViews) X(xrEnumerateSwapchainFormats)                    \
                    X(xrCreateSwapchain) X(xrDestroySwapchain) X(xrEnumerateSwapchainImages) X(xrAcquireSwapchainImage)                    \
                        X(xrWaitSwapchainImage) X(xrReleaseSwapchainImage) X(xrBeginSession) X(xrEndSession) X(xrRequestExitSession)       \
                            X(xrWaitFrame) X(xrBeginFrame) X(xrEndFrame) X(xrLocateViews) X(xrStringToPath) X(xrPathToString)              \
                                X(xrCreateActionSet) X(xrDestroyActionSet) X(xrCreateAction) X(xrDestroyAction)                            \
                                    X(xrSuggestInteractionProfileBindings) X(xrAttachSessionActionSets) X(xrGetCurrentInteractionProfile)  \
                                        X(xrGetActionStateBoolean) X(xrGetActionStateFloat) X(xrGetActionStateVector2f)                    \
                                            X(xrGetActionStatePose) X(xrSyncActions) X(xrEnumerateBoundSourcesForAction)                   \
                                                X(xrGetInputSourceLocalizedName) X(xrApplyHapticFeedback) X(xrStopHapticFeedback)

namespace entoptic::runtime::testing {

inline PFN_xrGetInstanceProcAddr negotiated(RuntimeHostFactory factory = &FakeHost::make) {
    const XrNegotiateLoaderInfo info{XR_LOADER_INTERFACE_STRUCT_LOADER_INFO,
                                     XR_LOADER_INFO_STRUCT_VERSION,
                                     sizeof(XrNegotiateLoaderInfo),
                                     1,
                                     1,
                                     XR_MAKE_VERSION(1, 0, 0),
                                     XR_MAKE_VERSION(1, 0x3ff, 0xfff)};
    XrNegotiateRuntimeRequest request{
        XR_LOADER_INTERFACE_STRUCT_RUNTIME_REQUEST, XR_RUNTIME_INFO_STRUCT_VERSION, sizeof(XrNegotiateRuntimeRequest), 0, 0, nullptr};
    EXPECT_EQ(negotiate(&info, &request, factory), XR_SUCCESS);
    return request.getInstanceProcAddr;
}

inline const std::vector<const char*>& all_extensions() {
    static const std::vector<const char*> names{
        "XR_KHR_vulkan_enable",           "XR_KHR_vulkan_enable2",        "XR_EXT_debug_utils",          "XR_EXT_eye_gaze_interaction",
        "XR_KHR_composition_layer_depth", "XR_KHR_convert_timespec_time", "XR_ENTOPTICX_scene_luminance"};
    return names;
}

// One instance with its fake host, or that of another factory.
class Client {
public:
    explicit Client(const std::vector<const char*>& extensions = all_extensions(), const void* chain = nullptr,
                    XrVersion version = XR_MAKE_VERSION(1, 0, 0), RuntimeHostFactory factory = &FakeHost::make)
        : get_proc(negotiated(factory)) {
        load();
        XrInstanceCreateInfo info{XR_TYPE_INSTANCE_CREATE_INFO, chain};
        std::strcpy(info.applicationInfo.applicationName, "test");
        info.applicationInfo.apiVersion = version;
        info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
        info.enabledExtensionNames = extensions.data();
        EXPECT_EQ(xrCreateInstance(&info, &instance), XR_SUCCESS);
        load();
        host = FakeHost::current();
    }
    ~Client() {
        if (instance) { EXPECT_EQ(xrDestroyInstance(instance), XR_SUCCESS); }
    }
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    template <class Function> Function get(const char* name) const {
        PFN_xrVoidFunction function = nullptr;
        static_cast<void>(get_proc(instance, name, &function));
        return reinterpret_cast<Function>(function);
    }
    XrPath path(const std::string& text) const {
        XrPath path = XR_NULL_PATH;
        EXPECT_EQ(xrStringToPath(instance, text.c_str(), &path), XR_SUCCESS) << text;
        return path;
    }
    std::string text(XrPath path) const {
        char buffer[XR_MAX_PATH_LENGTH];
        std::uint32_t count = 0;
        return xrPathToString(instance, path, sizeof(buffer), &count, buffer) == XR_SUCCESS ? buffer : "";
    }
    // Session states told since the last call, oldest first.
    std::vector<XrSessionState> states() const {
        std::vector<XrSessionState> found;
        XrEventDataBuffer event{XR_TYPE_EVENT_DATA_BUFFER};
        while (xrPollEvent(instance, &event) == XR_SUCCESS) {
            if (event.type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) {
                found.push_back(reinterpret_cast<const XrEventDataSessionStateChanged*>(&event)->state);
            }
            event = {XR_TYPE_EVENT_DATA_BUFFER};
        }
        return found;
    }

    PFN_xrGetInstanceProcAddr get_proc;
    XrInstance instance = XR_NULL_HANDLE;
    FakeHost* host = nullptr;
#define ENTOPTIC_MEMBER(name) PFN_##name name = nullptr;
    ENTOPTIC_CORE_FUNCTIONS(ENTOPTIC_MEMBER)
#undef ENTOPTIC_MEMBER

private:
    void load() {
#define ENTOPTIC_LOAD(name) name = get<PFN_##name>(#name);
        ENTOPTIC_CORE_FUNCTIONS(ENTOPTIC_LOAD)
#undef ENTOPTIC_LOAD
    }
};

// The application's Vulkan, made through XR_KHR_vulkan_enable2.
class VulkanApplication {
public:
    explicit VulkanApplication(Client& client, bool ask_requirements = true) {
        if (ask_requirements) {
            XrGraphicsRequirementsVulkan2KHR requirements{XR_TYPE_GRAPHICS_REQUIREMENTS_VULKAN2_KHR};
            EXPECT_EQ(client.get<PFN_xrGetVulkanGraphicsRequirements2KHR>("xrGetVulkanGraphicsRequirements2KHR")(client.instance, 1,
                                                                                                                 &requirements),
                      XR_SUCCESS);
        }
        VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "test", 0, "", 0, VK_API_VERSION_1_0};
        VkInstanceCreateInfo instance_info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, nullptr, 0, &application, 0, nullptr, 0, nullptr};
        XrVulkanInstanceCreateInfoKHR create{
            XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR, nullptr, 1, 0, &vkGetInstanceProcAddr, &instance_info, nullptr};
        VkResult result = VK_ERROR_UNKNOWN;
        EXPECT_EQ(client.get<PFN_xrCreateVulkanInstanceKHR>("xrCreateVulkanInstanceKHR")(client.instance, &create, &instance, &result),
                  XR_SUCCESS);
        EXPECT_EQ(result, VK_SUCCESS);
        XrVulkanGraphicsDeviceGetInfoKHR get{XR_TYPE_VULKAN_GRAPHICS_DEVICE_GET_INFO_KHR, nullptr, 1, instance};
        EXPECT_EQ(client.get<PFN_xrGetVulkanGraphicsDevice2KHR>("xrGetVulkanGraphicsDevice2KHR")(client.instance, &get, &physical),
                  XR_SUCCESS);
        const float priority = 1;
        VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, nullptr, 0, 0, 1, &priority};
        VkDeviceCreateInfo device_info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, nullptr, 0, 1, &queue, 0, nullptr, 0, nullptr, nullptr};
        XrVulkanDeviceCreateInfoKHR device_create{
            XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR, nullptr, 1, 0, &vkGetInstanceProcAddr, physical, &device_info, nullptr};
        EXPECT_EQ(client.get<PFN_xrCreateVulkanDeviceKHR>("xrCreateVulkanDeviceKHR")(client.instance, &device_create, &device, &result),
                  XR_SUCCESS);
        EXPECT_EQ(result, VK_SUCCESS);
    }
    ~VulkanApplication() {
        if (device) {
            proc<PFN_vkDeviceWaitIdle>("vkDeviceWaitIdle")(device);
            proc<PFN_vkDestroyDevice>("vkDestroyDevice")(device, nullptr);
        }
        if (instance) proc<PFN_vkDestroyInstance>("vkDestroyInstance")(instance, nullptr);
    }
    VulkanApplication(const VulkanApplication&) = delete;
    VulkanApplication& operator=(const VulkanApplication&) = delete;

    XrGraphicsBindingVulkan2KHR binding() const {
        return {XR_TYPE_GRAPHICS_BINDING_VULKAN2_KHR, nullptr, instance, physical, device, 0, 0};
    }
    template <class Function> Function proc(const char* name) const {
        return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance, name));
    }

    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
};

// An instance, a device, a session; helpers for the frame loop. Base of the conformance tests.
class SessionTest : public ::testing::Test {
public:
    SessionTest() = default;
    SessionTest(const std::vector<const char*>& extensions, XrVersion version) : xr(extensions, nullptr, version) {}
    void SetUp() override { session = make_session(); }
    void TearDown() override {
        if (session) { EXPECT_EQ(xr.xrDestroySession(session), XR_SUCCESS); }
    }

    XrSession make_session() {
        const auto binding = vulkan.binding();
        const XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO, &binding, 0, 1};
        XrSession made = XR_NULL_HANDLE;
        EXPECT_EQ(xr.xrCreateSession(xr.instance, &info, &made), XR_SUCCESS);
        return made;
    }
    XrResult begin_session() {
        const XrSessionBeginInfo info{XR_TYPE_SESSION_BEGIN_INFO, nullptr, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};
        return xr.xrBeginSession(session, &info);
    }
    XrFrameState wait_frame() {
        XrFrameState state{XR_TYPE_FRAME_STATE};
        EXPECT_EQ(xr.xrWaitFrame(session, nullptr, &state), XR_SUCCESS);
        return state;
    }
    XrResult end_frame(XrTime time, std::vector<const XrCompositionLayerBaseHeader*> layers = {}) {
        const XrFrameEndInfo info{
            XR_TYPE_FRAME_END_INFO, nullptr, time, XR_ENVIRONMENT_BLEND_MODE_OPAQUE, static_cast<std::uint32_t>(layers.size()),
            layers.data()};
        return xr.xrEndFrame(session, &info);
    }
    XrResult frame(std::vector<const XrCompositionLayerBaseHeader*> layers = {}) {
        const XrFrameState state = wait_frame();
        EXPECT_TRUE(XR_SUCCEEDED(xr.xrBeginFrame(session, nullptr)));
        return end_frame(state.predictedDisplayTime, std::move(layers));
    }
    void run_to_focus() {
        EXPECT_EQ(begin_session(), XR_SUCCESS);
        for (int i = 0; i < 3; ++i) EXPECT_EQ(frame(), XR_SUCCESS);
    }
    XrSpace reference_space(XrReferenceSpaceType type, XrPosef pose = {{0, 0, 0, 1}, {0, 0, 0}}) {
        const XrReferenceSpaceCreateInfo info{XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr, type, pose};
        XrSpace space = XR_NULL_HANDLE;
        EXPECT_EQ(xr.xrCreateReferenceSpace(session, &info, &space), XR_SUCCESS);
        return space;
    }
    static XrSwapchainCreateInfo swapchain_info(std::uint32_t array_size = 1) {
        return {XR_TYPE_SWAPCHAIN_CREATE_INFO,
                nullptr,
                0,
                XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT,
                VK_FORMAT_R8G8B8A8_SRGB,
                1,
                64,
                32,
                1,
                array_size,
                1};
    }
    XrSwapchain make_swapchain(const XrSwapchainCreateInfo& info = swapchain_info()) {
        XrSwapchain swapchain = XR_NULL_HANDLE;
        EXPECT_EQ(xr.xrCreateSwapchain(session, &info, &swapchain), XR_SUCCESS);
        return swapchain;
    }
    XrResult wait_image(XrSwapchain swapchain, XrDuration timeout = XR_INFINITE_DURATION) {
        const XrSwapchainImageWaitInfo info{XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, nullptr, timeout};
        return xr.xrWaitSwapchainImage(swapchain, &info);
    }
    std::uint32_t cycle(XrSwapchain swapchain) {
        std::uint32_t index = 99;
        EXPECT_EQ(xr.xrAcquireSwapchainImage(swapchain, nullptr, &index), XR_SUCCESS);
        EXPECT_EQ(wait_image(swapchain), XR_SUCCESS);
        EXPECT_EQ(xr.xrReleaseSwapchainImage(swapchain, nullptr), XR_SUCCESS);
        return index;
    }
    XrSpaceLocation locate(XrSpace space, XrSpace base, XrTime time, void* chain = nullptr) {
        XrSpaceLocation location{XR_TYPE_SPACE_LOCATION, chain};
        EXPECT_EQ(xr.xrLocateSpace(space, base, time, &location), XR_SUCCESS);
        return location;
    }
    XrTime now() const { return xr.host->clock().now(); }

    Client xr{all_extensions()};
    VulkanApplication vulkan{xr};
    XrSession session = XR_NULL_HANDLE;
};

}  // namespace entoptic::runtime::testing
