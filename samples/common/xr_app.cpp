#include "samples/common/xr_app.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <optional>
#include <thread>

#define XR_USE_GRAPHICS_API_VULKAN
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include <fmt/format.h>

#include "include/entoptic/XR_ENTOPTICX_observer.h"
#include "include/entoptic/XR_ENTOPTICX_scene_luminance.h"
#include "samples/common/failure.h"

namespace samples {

namespace {

volatile std::sig_atomic_t end_requested = 0;

struct Swapchain {
    XrSwapchain handle = XR_NULL_HANDLE;
    XrSwapchain depth = XR_NULL_HANDLE;  // null: not submitted
    EyeImages images;
};

struct Actions {
    XrActionSet set = XR_NULL_HANDLE;
    XrAction toggle = XR_NULL_HANDLE;
    XrAction dim_axis = XR_NULL_HANDLE;
    XrAction dim_trigger = XR_NULL_HANDLE;
};

// Thrown inside the frame loop when the session or the instance is gone: nothing of it may be called again.
struct Lost {
    const char* what;
};

}  // namespace

struct XrApp::State {
    XrAppOptions options;
    XrInstance instance = XR_NULL_HANDLE;
    XrSystemId system = XR_NULL_SYSTEM_ID;
    bool luminance_enabled = false, depth_enabled = false, observer_enabled = false;
    PFN_xrGetObserverENTOPTICX get_observer = nullptr;
    std::unique_ptr<Gpu> gpu;
    XrSession session = XR_NULL_HANDLE;
    XrSpace local_space = XR_NULL_HANDLE;
    XrEnvironmentBlendMode blend_mode = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
    std::vector<Swapchain> swapchains;
    Actions actions;
    bool running = false;  // between xrBeginSession and xrEndSession
    bool focused = false;
    bool finished = false;
    bool asked_to_end = false;
    std::optional<XrTime> first_display_time;
    std::uint64_t frames_drawn = 0;

    ~State();
    void check(XrResult result, const char* call) const;
    void create_instance();
    void find_system();
    void create_gpu();
    void create_session();
    void create_swapchains();
    std::vector<std::int64_t> offered_formats() const;
    VkFormat choose_format() const;
    std::vector<VkImage> create_swapchain(XrSwapchainCreateInfo& info, VkFormat format, XrSwapchainUsageFlags usage,
                                          XrSwapchain& handle) const;
    std::uint32_t acquire(XrSwapchain swapchain) const;
    void create_actions();
    void suggest(const char* profile, const std::vector<std::pair<XrAction, const char*>>& bindings) const;
    XrPath path(const char* text) const;
    void poll_events();
    void change_session_state(XrSessionState state);
    ControllerInput read_controllers() const;
    void request_session_end();
    void run_frame(Scene& scene);
    bool locate_views(XrTime time, std::vector<XrView>& views) const;
    void ask_observer(XrTime time, std::vector<EyeView>& views) const;
    void draw_views(Scene& scene, XrTime time, const std::vector<XrView>& views, std::vector<XrCompositionLayerProjectionView>& layer_views,
                    std::vector<XrCompositionLayerDepthInfoKHR>& depths);
};

// ---- instance and device ---------------------------------------------------------------------------------------------------------

static std::string result_name(XrInstance instance, XrResult result) {
    std::array<char, XR_MAX_RESULT_STRING_SIZE> name{};
    if (instance != XR_NULL_HANDLE && XR_SUCCEEDED(xrResultToString(instance, result, name.data()))) { return name.data(); }
    return fmt::format("XrResult {}", static_cast<int>(result));
}

void XrApp::State::check(XrResult result, const char* call) const {
    if (result == XR_ERROR_SESSION_LOST || result == XR_ERROR_INSTANCE_LOST) {
        throw Lost{result == XR_ERROR_SESSION_LOST ? "session" : "instance"};
    }
    if (XR_FAILED(result)) { throw Failure(ExitCode::failed, fmt::format("{} failed ({})", call, result_name(instance, result))); }
}

static bool has_extension(const std::vector<XrExtensionProperties>& extensions, const char* name) {
    return std::any_of(extensions.begin(), extensions.end(), [name](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

static std::vector<XrExtensionProperties> runtime_extensions() {
    std::uint32_t count = 0;
    XrResult result = xrEnumerateInstanceExtensionProperties(nullptr, 0, &count, nullptr);
    std::vector<XrExtensionProperties> extensions(count, {XR_TYPE_EXTENSION_PROPERTIES});
    if (XR_SUCCEEDED(result)) { result = xrEnumerateInstanceExtensionProperties(nullptr, count, &count, extensions.data()); }
    if (XR_FAILED(result)) {
        throw Failure(ExitCode::missing,
                      "no OpenXR runtime: start this program with `entoptic run -- …`, make one active with "
                      "`entoptic runtime set`, or name a runtime's manifest in XR_RUNTIME_JSON");
    }
    return extensions;
}

void XrApp::State::create_instance() {
    const auto offered = runtime_extensions();
    if (!has_extension(offered, XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME)) {
        throw Failure(ExitCode::missing, "this OpenXR runtime lacks XR_KHR_vulkan_enable2: use one that takes Vulkan applications");
    }
    std::vector<const char*> enabled{XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME};
    luminance_enabled = options.scene_luminance && has_extension(offered, XR_ENTOPTICX_SCENE_LUMINANCE_EXTENSION_NAME);
    if (luminance_enabled) { enabled.push_back(XR_ENTOPTICX_SCENE_LUMINANCE_EXTENSION_NAME); }
    depth_enabled = options.far_m > 0 && has_extension(offered, XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME);
    if (depth_enabled) { enabled.push_back(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME); }
    observer_enabled = options.gaze && has_extension(offered, XR_ENTOPTICX_OBSERVER_EXTENSION_NAME);
    if (observer_enabled) { enabled.push_back(XR_ENTOPTICX_OBSERVER_EXTENSION_NAME); }
    XrInstanceCreateInfo info{XR_TYPE_INSTANCE_CREATE_INFO};
    options.application.copy(info.applicationInfo.applicationName, XR_MAX_APPLICATION_NAME_SIZE - 1);
    info.applicationInfo.applicationVersion = 1;
    std::strcpy(info.applicationInfo.engineName, "Entoptic samples");
    info.applicationInfo.engineVersion = 1;
    info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 20);
    info.enabledExtensionCount = static_cast<std::uint32_t>(enabled.size());
    info.enabledExtensionNames = enabled.data();
    if (const XrResult result = xrCreateInstance(&info, &instance); XR_FAILED(result)) {
        throw Failure(ExitCode::missing, fmt::format("the OpenXR runtime does not start ({}): see its own messages above, or "
                                                     "`entoptic doctor`",
                                                     result_name(XR_NULL_HANDLE, result)));
    }
}

// Where each eye looks at `time` and what it resolves there, into views that know where they are.
void XrApp::State::ask_observer(XrTime time, std::vector<EyeView>& views) const {
    if (!observer_enabled || views.size() != 2) { return; }
    const XrObserverGetInfoENTOPTICX info{XR_TYPE_OBSERVER_GET_INFO_ENTOPTICX, nullptr, local_space, time};
    XrObserverDetailENTOPTICX detail{XR_TYPE_OBSERVER_DETAIL_ENTOPTICX, nullptr, {}, 0, 0};
    XrObserverENTOPTICX observer{XR_TYPE_OBSERVER_ENTOPTICX};
    observer.next = &detail;
    check(get_observer(session, &info, &observer), "xrGetObserverENTOPTICX");
    constexpr XrSpaceLocationFlags needed = XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT;
    if ((observer.headLocationFlags & needed) != needed) { return; }
    for (std::size_t eye = 0; eye < 2; ++eye) {
        const XrObserverEyeENTOPTICX& seen = observer.eyes[eye];
        if (seen.gazeProvenance == XR_OBSERVER_PROVENANCE_ABSENT_ENTOPTICX) { continue; }
        const XrVector3f& d = seen.gazeDirection;
        views[eye].seen = {glm::inverse(views[eye].orientation) * glm::vec3(d.x, d.y, d.z), detail.resolvedAngle[eye],
                           detail.eccentricityFactor};
    }
}

void XrApp::State::find_system() {
    XrSystemGetInfo info{XR_TYPE_SYSTEM_GET_INFO};
    info.formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
    const XrResult result = xrGetSystem(instance, &info, &system);
    if (result == XR_ERROR_FORM_FACTOR_UNAVAILABLE || result == XR_ERROR_FORM_FACTOR_UNSUPPORTED) {
        throw Failure(ExitCode::missing, "the OpenXR runtime has no headset: plug it in, or use `entoptic run --hmd virtual -- …`");
    }
    check(result, "xrGetSystem");
    std::uint32_t count = 0;
    check(xrEnumerateEnvironmentBlendModes(instance, system, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, 0, &count, nullptr),
          "xrEnumerateEnvironmentBlendModes");
    std::vector<XrEnvironmentBlendMode> modes(count);
    check(xrEnumerateEnvironmentBlendModes(instance, system, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, count, &count, modes.data()),
          "xrEnumerateEnvironmentBlendModes");
    if (!modes.empty() && std::find(modes.begin(), modes.end(), XR_ENVIRONMENT_BLEND_MODE_OPAQUE) == modes.end()) {
        blend_mode = modes.front();
    }
}

template <typename Function> static Function load(XrInstance instance, const char* name) {
    PFN_xrVoidFunction function = nullptr;
    if (XR_FAILED(xrGetInstanceProcAddr(instance, name, &function)) || function == nullptr) {
        throw Failure(ExitCode::missing, fmt::format("the OpenXR runtime lacks {}", name));
    }
    return reinterpret_cast<Function>(function);
}

void XrApp::State::create_gpu() {
    const auto get_requirements = load<PFN_xrGetVulkanGraphicsRequirements2KHR>(instance, "xrGetVulkanGraphicsRequirements2KHR");
    XrGraphicsRequirementsVulkan2KHR requirements{XR_TYPE_GRAPHICS_REQUIREMENTS_VULKAN2_KHR};
    check(get_requirements(instance, system, &requirements), "xrGetVulkanGraphicsRequirements2KHR");
    if (requirements.minApiVersionSupported > XR_MAKE_VERSION(1, 2, 0xFFFFFFFF)) {
        throw Failure(ExitCode::missing, "the OpenXR runtime wants a newer Vulkan than 1.2, which this program uses");
    }
    Gpu::Factory factory;
    factory.create_instance = [this](const VkInstanceCreateInfo& vulkan, VkInstance* out) {
        XrVulkanInstanceCreateInfoKHR info{XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR};
        info.systemId = system;
        info.pfnGetInstanceProcAddr = &vkGetInstanceProcAddr;
        info.vulkanCreateInfo = &vulkan;
        VkResult vulkan_result = VK_SUCCESS;
        const auto create = load<PFN_xrCreateVulkanInstanceKHR>(instance, "xrCreateVulkanInstanceKHR");
        check(create(instance, &info, out, &vulkan_result), "xrCreateVulkanInstanceKHR");
        return vulkan_result;
    };
    factory.choose_device = [this](VkInstance vulkan) {
        XrVulkanGraphicsDeviceGetInfoKHR info{XR_TYPE_VULKAN_GRAPHICS_DEVICE_GET_INFO_KHR};
        info.systemId = system;
        info.vulkanInstance = vulkan;
        VkPhysicalDevice device = VK_NULL_HANDLE;
        const auto get = load<PFN_xrGetVulkanGraphicsDevice2KHR>(instance, "xrGetVulkanGraphicsDevice2KHR");
        check(get(instance, &info, &device), "xrGetVulkanGraphicsDevice2KHR");
        return device;
    };
    factory.create_device = [this](VkPhysicalDevice physical, const VkDeviceCreateInfo& vulkan, VkDevice* out) {
        XrVulkanDeviceCreateInfoKHR info{XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR};
        info.systemId = system;
        info.pfnGetInstanceProcAddr = &vkGetInstanceProcAddr;
        info.vulkanPhysicalDevice = physical;
        info.vulkanCreateInfo = &vulkan;
        VkResult vulkan_result = VK_SUCCESS;
        const auto create = load<PFN_xrCreateVulkanDeviceKHR>(instance, "xrCreateVulkanDeviceKHR");
        check(create(instance, &info, out, &vulkan_result), "xrCreateVulkanDeviceKHR");
        return vulkan_result;
    };
    gpu = std::make_unique<Gpu>(options.application, factory);
}

// ---- session and swapchains --------------------------------------------------------------------------------------------------------

void XrApp::State::create_session() {
    XrGraphicsBindingVulkan2KHR binding{XR_TYPE_GRAPHICS_BINDING_VULKAN2_KHR};
    binding.instance = gpu->instance();
    binding.physicalDevice = gpu->physical_device();
    binding.device = gpu->device();
    binding.queueFamilyIndex = gpu->queue_family();
    binding.queueIndex = 0;
    XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO};
    info.next = &binding;
    info.systemId = system;
    check(xrCreateSession(instance, &info, &session), "xrCreateSession");

    XrReferenceSpaceCreateInfo space{XR_TYPE_REFERENCE_SPACE_CREATE_INFO};
    space.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL;
    space.poseInReferenceSpace.orientation.w = 1.0F;
    check(xrCreateReferenceSpace(session, &space, &local_space), "xrCreateReferenceSpace");
    if (observer_enabled) { get_observer = load<PFN_xrGetObserverENTOPTICX>(instance, "xrGetObserverENTOPTICX"); }
}

std::vector<std::int64_t> XrApp::State::offered_formats() const {
    std::uint32_t count = 0;
    check(xrEnumerateSwapchainFormats(session, 0, &count, nullptr), "xrEnumerateSwapchainFormats");
    std::vector<std::int64_t> offered(count);
    check(xrEnumerateSwapchainFormats(session, count, &count, offered.data()), "xrEnumerateSwapchainFormats");
    return offered;
}

VkFormat XrApp::State::choose_format() const {
    const std::vector<std::int64_t> offered = offered_formats();
    for (VkFormat format : options.formats) {
        if (std::find(offered.begin(), offered.end(), static_cast<std::int64_t>(format)) != offered.end()) { return format; }
    }
    throw Failure(ExitCode::missing,
                  "the OpenXR runtime offers no floating-point swapchain (R16G16B16A16_SFLOAT), without which "
                  "a scene cannot keep its luminance");
}

std::vector<VkImage> XrApp::State::create_swapchain(XrSwapchainCreateInfo& info, VkFormat format, XrSwapchainUsageFlags usage,
                                                    XrSwapchain& handle) const {
    info.format = format;
    info.usageFlags = usage;
    check(xrCreateSwapchain(session, &info, &handle), "xrCreateSwapchain");
    std::uint32_t count = 0;
    check(xrEnumerateSwapchainImages(handle, 0, &count, nullptr), "xrEnumerateSwapchainImages");
    std::vector<XrSwapchainImageVulkan2KHR> images(count, {XR_TYPE_SWAPCHAIN_IMAGE_VULKAN2_KHR});
    check(xrEnumerateSwapchainImages(handle, count, &count, reinterpret_cast<XrSwapchainImageBaseHeader*>(images.data())),
          "xrEnumerateSwapchainImages");
    std::vector<VkImage> handles;
    for (const auto& image : images) { handles.push_back(image.image); }
    return handles;
}

void XrApp::State::create_swapchains() {
    std::uint32_t count = 0;
    constexpr auto stereo = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
    check(xrEnumerateViewConfigurationViews(instance, system, stereo, 0, &count, nullptr), "xrEnumerateViewConfigurationViews");
    std::vector<XrViewConfigurationView> views(count, {XR_TYPE_VIEW_CONFIGURATION_VIEW});
    check(xrEnumerateViewConfigurationViews(instance, system, stereo, count, &count, views.data()), "xrEnumerateViewConfigurationViews");
    const VkFormat format = choose_format();
    const std::vector<std::int64_t> offered = offered_formats();
    depth_enabled = depth_enabled && std::find(offered.begin(), offered.end(), VK_FORMAT_D32_SFLOAT) != offered.end();
    for (const XrViewConfigurationView& view : views) {
        XrSwapchainCreateInfo info{XR_TYPE_SWAPCHAIN_CREATE_INFO};
        info.sampleCount = 1;
        info.width = view.recommendedImageRectWidth;
        info.height = view.recommendedImageRectHeight;
        info.faceCount = 1;
        info.arraySize = 1;
        info.mipCount = 1;
        Swapchain& swapchain = swapchains.emplace_back();
        swapchain.images.extent = {info.width, info.height};
        swapchain.images.format = format;
        swapchain.images.images =
            create_swapchain(info, format, XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_SAMPLED_BIT, swapchain.handle);
        if (depth_enabled) {
            swapchain.images.depth_images =
                create_swapchain(info, VK_FORMAT_D32_SFLOAT, XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, swapchain.depth);
        }
    }
}

// ---- controllers ------------------------------------------------------------------------------------------------------------------

XrPath XrApp::State::path(const char* text) const {
    XrPath result = XR_NULL_PATH;
    check(xrStringToPath(instance, text, &result), "xrStringToPath");
    return result;
}

// A profile that the runtime does not know is no error: the others remain.
void XrApp::State::suggest(const char* profile, const std::vector<std::pair<XrAction, const char*>>& bindings) const {
    std::vector<XrActionSuggestedBinding> list;
    for (const auto& [action, input] : bindings) {
        list.push_back({action, path((std::string("/user/hand/left/input/") + input).c_str())});
        list.push_back({action, path((std::string("/user/hand/right/input/") + input).c_str())});
    }
    XrInteractionProfileSuggestedBinding info{XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING};
    info.interactionProfile = path(profile);
    info.countSuggestedBindings = static_cast<std::uint32_t>(list.size());
    info.suggestedBindings = list.data();
    xrSuggestInteractionProfileBindings(instance, &info);
}

void XrApp::State::create_actions() {
    XrActionSetCreateInfo set{XR_TYPE_ACTION_SET_CREATE_INFO};
    std::strcpy(set.actionSetName, "light");
    std::strcpy(set.localizedActionSetName, "Light");
    check(xrCreateActionSet(instance, &set, &actions.set), "xrCreateActionSet");
    const auto create = [this](const char* name, const char* shown, XrActionType type) {
        XrActionCreateInfo info{XR_TYPE_ACTION_CREATE_INFO};
        info.actionType = type;
        std::strcpy(info.actionName, name);
        std::strcpy(info.localizedActionName, shown);
        XrAction action = XR_NULL_HANDLE;
        check(xrCreateAction(actions.set, &info, &action), "xrCreateAction");
        return action;
    };
    actions.toggle = create("toggle_lamp", "Toggle the lamp", XR_ACTION_TYPE_BOOLEAN_INPUT);
    actions.dim_axis = create("dim_axis", "Dim or brighten", XR_ACTION_TYPE_FLOAT_INPUT);
    actions.dim_trigger = create("dim", "Dim", XR_ACTION_TYPE_FLOAT_INPUT);
    suggest("/interaction_profiles/khr/simple_controller", {{actions.toggle, "select/click"}});
    suggest("/interaction_profiles/htc/vive_controller",
            {{actions.toggle, "trackpad/click"}, {actions.dim_axis, "trackpad/y"}, {actions.dim_trigger, "trigger/value"}});
    suggest("/interaction_profiles/valve/index_controller",
            {{actions.toggle, "a/click"}, {actions.dim_axis, "thumbstick/y"}, {actions.dim_trigger, "trigger/value"}});
    suggest("/interaction_profiles/oculus/touch_controller",
            {{actions.toggle, "thumbstick/click"}, {actions.dim_axis, "thumbstick/y"}, {actions.dim_trigger, "trigger/value"}});
    XrSessionActionSetsAttachInfo attach{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO};
    attach.countActionSets = 1;
    attach.actionSets = &actions.set;
    check(xrAttachSessionActionSets(session, &attach), "xrAttachSessionActionSets");
}

ControllerInput XrApp::State::read_controllers() const {
    ControllerInput input;
    if (actions.set == XR_NULL_HANDLE || !focused) { return input; }
    const XrActiveActionSet active{actions.set, XR_NULL_PATH};
    XrActionsSyncInfo sync{XR_TYPE_ACTIONS_SYNC_INFO};
    sync.countActiveActionSets = 1;
    sync.activeActionSets = &active;
    const XrResult result = xrSyncActions(session, &sync);
    check(result, "xrSyncActions");
    if (result == XR_SESSION_NOT_FOCUSED) { return input; }
    XrActionStateGetInfo get{XR_TYPE_ACTION_STATE_GET_INFO};
    get.action = actions.toggle;
    XrActionStateBoolean toggle{XR_TYPE_ACTION_STATE_BOOLEAN};
    check(xrGetActionStateBoolean(session, &get, &toggle), "xrGetActionStateBoolean");
    input.toggle = toggle.isActive && toggle.changedSinceLastSync && toggle.currentState;
    const auto read_float = [&](XrAction action) {
        get.action = action;
        XrActionStateFloat value{XR_TYPE_ACTION_STATE_FLOAT};
        check(xrGetActionStateFloat(session, &get, &value), "xrGetActionStateFloat");
        return value.isActive ? value.currentState : 0.0F;
    };
    input.dim = std::clamp(read_float(actions.dim_axis) - read_float(actions.dim_trigger), -1.0F, 1.0F);
    return input;
}

// ---- events and frames --------------------------------------------------------------------------------------------------------------

void XrApp::State::change_session_state(XrSessionState state) {
    focused = state == XR_SESSION_STATE_FOCUSED;
    switch (state) {
        case XR_SESSION_STATE_READY: {
            XrSessionBeginInfo begin{XR_TYPE_SESSION_BEGIN_INFO};
            begin.primaryViewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
            check(xrBeginSession(session, &begin), "xrBeginSession");
            running = true;
            break;
        }
        case XR_SESSION_STATE_STOPPING:
            check(xrEndSession(session), "xrEndSession");
            running = false;
            break;
        case XR_SESSION_STATE_EXITING:
            finished = true;
            break;
        case XR_SESSION_STATE_LOSS_PENDING:
            throw Lost{"session"};
        default:  // IDLE, SYNCHRONIZED, VISIBLE, FOCUSED: xrWaitFrame and shouldRender say what to do
            break;
    }
}

void XrApp::State::poll_events() {
    for (;;) {
        XrEventDataBuffer event{XR_TYPE_EVENT_DATA_BUFFER};
        const XrResult result = xrPollEvent(instance, &event);
        check(result, "xrPollEvent");
        if (result == XR_EVENT_UNAVAILABLE) { return; }
        if (event.type == XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING) { throw Lost{"instance"}; }
        if (event.type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) {
            XrEventDataSessionStateChanged change{};
            std::memcpy(&change, &event, sizeof(change));
            if (change.session == session) { change_session_state(change.state); }
        }
    }
}

// The OpenXR way to leave: ask, go on with frames, and end the session when the runtime says STOPPING.
void XrApp::State::request_session_end() {
    if (asked_to_end) { return; }
    asked_to_end = true;
    if (!running) {
        finished = true;
        return;
    }
    check(xrRequestExitSession(session), "xrRequestExitSession");
}

bool XrApp::State::locate_views(XrTime time, std::vector<XrView>& views) const {
    XrViewLocateInfo info{XR_TYPE_VIEW_LOCATE_INFO};
    info.viewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
    info.displayTime = time;
    info.space = local_space;
    XrViewState view_state{XR_TYPE_VIEW_STATE};
    std::uint32_t count = 0;
    views.assign(swapchains.size(), {XR_TYPE_VIEW});
    check(xrLocateViews(session, &info, &view_state, static_cast<std::uint32_t>(views.size()), &count, views.data()), "xrLocateViews");
    constexpr XrViewStateFlags needed = XR_VIEW_STATE_ORIENTATION_VALID_BIT | XR_VIEW_STATE_POSITION_VALID_BIT;
    return (view_state.viewStateFlags & needed) == needed;
}

static EyeView eye_view_of(const XrView& view) {
    const auto& [orientation, position] = view.pose;
    EyeView eye;
    eye.position = {position.x, position.y, position.z};
    eye.orientation = glm::quat(orientation.w, orientation.x, orientation.y, orientation.z);
    eye.tan_left = std::tan(view.fov.angleLeft);
    eye.tan_right = std::tan(view.fov.angleRight);
    eye.tan_up = std::tan(view.fov.angleUp);
    eye.tan_down = std::tan(view.fov.angleDown);
    return eye;
}

std::uint32_t XrApp::State::acquire(XrSwapchain swapchain) const {
    std::uint32_t image = 0;
    check(xrAcquireSwapchainImage(swapchain, nullptr, &image), "xrAcquireSwapchainImage");
    XrSwapchainImageWaitInfo wait{XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO};
    wait.timeout = XR_INFINITE_DURATION;
    check(xrWaitSwapchainImage(swapchain, &wait), "xrWaitSwapchainImage");
    return image;
}

void XrApp::State::draw_views(Scene& scene, XrTime time, const std::vector<XrView>& views,
                              std::vector<XrCompositionLayerProjectionView>& layer_views,
                              std::vector<XrCompositionLayerDepthInfoKHR>& depths) {
    depths.resize(swapchains.size());  // the layer's views point to them
    std::vector<EyeView> eye_views;
    for (const XrView& view : views) { eye_views.push_back(eye_view_of(view)); }
    ask_observer(time, eye_views);
    for (std::uint32_t eye = 0; eye < swapchains.size(); ++eye) {
        const Swapchain& swapchain = swapchains[eye];
        const std::uint32_t image = acquire(swapchain.handle), depth = depth_enabled ? acquire(swapchain.depth) : 0;
        scene.draw(eye, image, depth, eye_views[eye]);
        check(xrReleaseSwapchainImage(swapchain.handle, nullptr), "xrReleaseSwapchainImage");

        XrCompositionLayerProjectionView& layer_view = layer_views.emplace_back();
        layer_view = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW};
        layer_view.pose = views[eye].pose;
        layer_view.fov = views[eye].fov;
        layer_view.subImage.swapchain = swapchain.handle;
        layer_view.subImage.imageRect.extent = {static_cast<std::int32_t>(swapchain.images.extent.width),
                                                static_cast<std::int32_t>(swapchain.images.extent.height)};
        if (!depth_enabled) { continue; }
        check(xrReleaseSwapchainImage(swapchain.depth, nullptr), "xrReleaseSwapchainImage");
        depths[eye] = {XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR};
        depths[eye].subImage = layer_view.subImage;
        depths[eye].subImage.swapchain = swapchain.depth;
        depths[eye].minDepth = 0;
        depths[eye].maxDepth = 1;
        depths[eye].nearZ = options.near_m;
        depths[eye].farZ = options.far_m;
        layer_view.next = &depths[eye];
    }
}

void XrApp::State::run_frame(Scene& scene) {
    XrFrameState frame{XR_TYPE_FRAME_STATE};
    check(xrWaitFrame(session, nullptr, &frame), "xrWaitFrame");
    check(xrBeginFrame(session, nullptr), "xrBeginFrame");
    first_display_time = first_display_time.value_or(frame.predictedDisplayTime);
    const FrameTime time{static_cast<double>(frame.predictedDisplayTime - *first_display_time) * 1e-9,
                         static_cast<double>(frame.predictedDisplayPeriod) * 1e-9};
    const bool go_on = scene.update(time, read_controllers());

    std::vector<XrView> views;
    std::vector<XrCompositionLayerProjectionView> layer_views;
    std::vector<XrCompositionLayerDepthInfoKHR> depths;
    if (frame.shouldRender && locate_views(frame.predictedDisplayTime, views)) {
        draw_views(scene, frame.predictedDisplayTime, views, layer_views, depths);
        ++frames_drawn;
    }
    XrCompositionLayerSceneLuminanceENTOPTICX luminance{XR_TYPE_COMPOSITION_LAYER_SCENE_LUMINANCE_ENTOPTICX, nullptr,
                                                        scene.luminance_per_unit()};
    XrCompositionLayerProjection layer{XR_TYPE_COMPOSITION_LAYER_PROJECTION};
    layer.next = luminance_enabled ? &luminance : nullptr;
    layer.space = local_space;
    layer.viewCount = static_cast<std::uint32_t>(layer_views.size());
    layer.views = layer_views.data();
    const auto* base = reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer);
    XrFrameEndInfo end{XR_TYPE_FRAME_END_INFO};
    end.displayTime = frame.predictedDisplayTime;
    end.environmentBlendMode = blend_mode;
    end.layerCount = layer_views.empty() ? 0 : 1;
    end.layers = &base;
    check(xrEndFrame(session, &end), "xrEndFrame");

    const bool enough = (options.frames > 0 && frames_drawn >= options.frames) || (options.seconds > 0 && time.seconds >= options.seconds);
    if (!go_on || enough) { request_session_end(); }
}

// ---- the public face ----------------------------------------------------------------------------------------------------------------

XrApp::State::~State() {
    if (gpu) { vkDeviceWaitIdle(gpu->device()); }
    for (const Swapchain& swapchain : swapchains) {
        xrDestroySwapchain(swapchain.handle);
        if (swapchain.depth != XR_NULL_HANDLE) { xrDestroySwapchain(swapchain.depth); }
    }
    if (local_space != XR_NULL_HANDLE) { xrDestroySpace(local_space); }
    if (session != XR_NULL_HANDLE) { xrDestroySession(session); }
    if (actions.set != XR_NULL_HANDLE) { xrDestroyActionSet(actions.set); }
    gpu.reset();  // made by the runtime, so it goes before the runtime's instance
    if (instance != XR_NULL_HANDLE) { xrDestroyInstance(instance); }
}

XrApp::XrApp(XrAppOptions options) : state_(std::make_unique<State>()) {
    state_->options = std::move(options);
    state_->create_instance();
    state_->find_system();
    state_->create_gpu();
}

XrApp::~XrApp() = default;

const Gpu& XrApp::gpu() const { return *state_->gpu; }

bool XrApp::tells_luminance() const { return state_->luminance_enabled; }

void XrApp::request_end() { end_requested = 1; }

namespace {

// However the loop ends, nothing may be destroyed while the device still works on it.
struct IdleAtExit {
    VkDevice device;
    ~IdleAtExit() { vkDeviceWaitIdle(device); }
};

}  // namespace

void XrApp::run(Scene& scene) {
    State& state = *state_;
    const IdleAtExit idle{state.gpu->device()};
    try {
        state.create_session();
        state.create_swapchains();
        if (state.options.controllers) { state.create_actions(); }
        std::vector<EyeImages> eyes;
        for (const Swapchain& swapchain : state.swapchains) { eyes.push_back(swapchain.images); }
        scene.prepare(*state.gpu, eyes);
        while (!state.finished) {
            state.poll_events();
            if (end_requested != 0) { state.request_session_end(); }
            if (state.running) {
                state.run_frame(scene);
            } else if (!state.finished) {
                std::this_thread::sleep_for(std::chrono::milliseconds(5));  // the runtime has not called us yet
            }
        }
    } catch (const Lost& lost) {
        throw Failure(ExitCode::failed, fmt::format("the OpenXR {} was lost: the runtime stopped, start the program again", lost.what));
    }
}

}  // namespace samples
