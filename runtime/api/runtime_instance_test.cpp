// labels: unit
// Instances without a session: negotiation, xrGetInstanceProcAddr, creation, two-call, names, system, time, debug utils.
#include "runtime/testing/client.h"

#include <set>
#include <cmath>
#include <map>

namespace entoptic::runtime::testing {
namespace {

XrInstanceCreateInfo create_info() {
    XrInstanceCreateInfo info{XR_TYPE_INSTANCE_CREATE_INFO};
    std::strcpy(info.applicationInfo.applicationName, "test");
    info.applicationInfo.apiVersion = XR_CURRENT_API_VERSION;
    return info;
}

PFN_xrCreateInstance create_function() {
    PFN_xrVoidFunction function = nullptr;
    EXPECT_EQ(negotiated()(XR_NULL_HANDLE, "xrCreateInstance", &function), XR_SUCCESS);
    return reinterpret_cast<PFN_xrCreateInstance>(function);
}

XrResult try_create(const XrInstanceCreateInfo& info) {
    XrInstance instance = XR_NULL_HANDLE;
    const XrResult result = create_function()(&info, &instance);
    if (result == XR_SUCCESS) {
        PFN_xrVoidFunction destroy = nullptr;
        EXPECT_EQ(negotiated()(instance, "xrDestroyInstance", &destroy), XR_SUCCESS);
        EXPECT_EQ(reinterpret_cast<PFN_xrDestroyInstance>(destroy)(instance), XR_SUCCESS);
    }
    return result;
}

TEST(Negotiate, AgreesOrRefuses) {
    XrNegotiateLoaderInfo info{
        XR_LOADER_INTERFACE_STRUCT_LOADER_INFO, 1, sizeof(info), 1, 1, XR_MAKE_VERSION(1, 0, 0), XR_MAKE_VERSION(1, 1, 0)};
    XrNegotiateRuntimeRequest request{XR_LOADER_INTERFACE_STRUCT_RUNTIME_REQUEST, 1, sizeof(request), 0, 0, nullptr};
    ASSERT_EQ(negotiate(&info, &request, &FakeHost::make), XR_SUCCESS);
    EXPECT_EQ(request.runtimeInterfaceVersion, 1u);
    EXPECT_EQ(XR_VERSION_MAJOR(request.runtimeApiVersion), 1u);
    EXPECT_EQ(XR_VERSION_MINOR(request.runtimeApiVersion), 1u);
    EXPECT_NE(request.getInstanceProcAddr, nullptr);
    EXPECT_EQ(negotiate(nullptr, &request, &FakeHost::make), XR_ERROR_INITIALIZATION_FAILED);
    EXPECT_EQ(negotiate(&info, nullptr, &FakeHost::make), XR_ERROR_INITIALIZATION_FAILED);
    info.minInterfaceVersion = info.maxInterfaceVersion = 2;
    EXPECT_EQ(negotiate(&info, &request, &FakeHost::make), XR_ERROR_INITIALIZATION_FAILED);
    info.minInterfaceVersion = 1;
    info.structSize = 3;
    EXPECT_EQ(negotiate(&info, &request, &FakeHost::make), XR_ERROR_INITIALIZATION_FAILED);
}

TEST(ProcAddr, WithoutInstance) {
    const auto get = negotiated();
    PFN_xrVoidFunction function = nullptr;
    for (const char* name :
         {"xrCreateInstance", "xrEnumerateApiLayerProperties", "xrEnumerateInstanceExtensionProperties", "xrGetInstanceProcAddr"}) {
        EXPECT_EQ(get(XR_NULL_HANDLE, name, &function), XR_SUCCESS) << name;
        EXPECT_NE(function, nullptr);
    }
    EXPECT_EQ(get(XR_NULL_HANDLE, "xrDestroyInstance", &function), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(function, nullptr);
    EXPECT_EQ(get(XR_NULL_HANDLE, nullptr, &function), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(get(XR_NULL_HANDLE, "xrCreateInstance", nullptr), XR_ERROR_VALIDATION_FAILURE);
}

TEST(ProcAddr, EveryCoreFunctionResolves) {
    Client xr(std::vector<const char*>{});
#define ENTOPTIC_EXPECT(name) EXPECT_NE(xr.name, nullptr) << #name;
    ENTOPTIC_CORE_FUNCTIONS(ENTOPTIC_EXPECT)
#undef ENTOPTIC_EXPECT
    PFN_xrVoidFunction function = nullptr;
    EXPECT_EQ(xr.get_proc(xr.instance, "xrNoSuchFunction", &function), XR_ERROR_FUNCTION_UNSUPPORTED);
}

TEST(ProcAddr, ExtensionFunctionsOnlyWhenEnabled) {
    const std::map<const char*, std::vector<const char*>> functions{
        {"XR_EXT_debug_utils",
         {"xrCreateDebugUtilsMessengerEXT", "xrDestroyDebugUtilsMessengerEXT", "xrSubmitDebugUtilsMessageEXT",
          "xrSetDebugUtilsObjectNameEXT", "xrSessionBeginDebugUtilsLabelRegionEXT", "xrSessionEndDebugUtilsLabelRegionEXT",
          "xrSessionInsertDebugUtilsLabelEXT"}},
        {"XR_KHR_convert_timespec_time", {"xrConvertTimespecTimeToTimeKHR", "xrConvertTimeToTimespecTimeKHR"}},
        {"XR_KHR_vulkan_enable",
         {"xrGetVulkanInstanceExtensionsKHR", "xrGetVulkanDeviceExtensionsKHR", "xrGetVulkanGraphicsDeviceKHR",
          "xrGetVulkanGraphicsRequirementsKHR"}},
        {"XR_KHR_vulkan_enable2",
         {"xrCreateVulkanInstanceKHR", "xrCreateVulkanDeviceKHR", "xrGetVulkanGraphicsDevice2KHR", "xrGetVulkanGraphicsRequirements2KHR"}}};
    Client without(std::vector<const char*>{});
    for (const auto& [extension, names] : functions) {
        Client with(std::vector<const char*>{extension});
        for (const char* name : names) {
            PFN_xrVoidFunction function = nullptr;
            EXPECT_EQ(without.get_proc(without.instance, name, &function), XR_ERROR_FUNCTION_UNSUPPORTED) << name;
            EXPECT_EQ(with.get_proc(with.instance, name, &function), XR_SUCCESS) << name;
        }
    }
}

TEST(CreateInstance, ApiVersions) {
    XrInstanceCreateInfo info = create_info();
    EXPECT_EQ(try_create(info), XR_SUCCESS);
    info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0xffffff);
    EXPECT_EQ(try_create(info), XR_SUCCESS);
    info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 1, 0);
    EXPECT_EQ(try_create(info), XR_SUCCESS);
    for (const XrVersion version :
         std::vector<XrVersion>{XR_MAKE_VERSION(1, 2, 0), XR_MAKE_VERSION(0, 9, 0), XR_MAKE_VERSION(2, 0, 0), 0}) {
        info.applicationInfo.apiVersion = version;
        EXPECT_EQ(try_create(info), XR_ERROR_API_VERSION_UNSUPPORTED) << version;
    }
}

TEST(CreateInstance, BadArguments) {
    XrInstance instance = XR_NULL_HANDLE;
    EXPECT_EQ(create_function()(nullptr, &instance), XR_ERROR_VALIDATION_FAILURE);
    XrInstanceCreateInfo info = create_info();
    EXPECT_EQ(create_function()(&info, nullptr), XR_ERROR_VALIDATION_FAILURE);
    info.type = XR_TYPE_ACTIONS_SYNC_INFO;
    EXPECT_EQ(try_create(info), XR_ERROR_VALIDATION_FAILURE);
    info = create_info();
    info.createFlags = 1;
    EXPECT_EQ(try_create(info), XR_ERROR_VALIDATION_FAILURE);
    info = create_info();
    info.applicationInfo.applicationName[0] = 0;
    EXPECT_EQ(try_create(info), XR_ERROR_NAME_INVALID);
    std::memset(info.applicationInfo.applicationName, 'a', XR_MAX_APPLICATION_NAME_SIZE);
    EXPECT_EQ(try_create(info), XR_ERROR_NAME_INVALID);
    info = create_info();
    std::memset(info.applicationInfo.engineName, 'a', XR_MAX_ENGINE_NAME_SIZE);
    EXPECT_EQ(try_create(info), XR_ERROR_NAME_INVALID);
    info = create_info();
    const char* bogus[] = {"XR_KHR_bogus"};
    info.enabledExtensionCount = 1;
    info.enabledExtensionNames = bogus;
    EXPECT_EQ(try_create(info), XR_ERROR_EXTENSION_NOT_PRESENT);
    info.enabledExtensionNames = nullptr;
    EXPECT_EQ(try_create(info), XR_ERROR_VALIDATION_FAILURE);
    info = create_info();
    info.enabledApiLayerCount = 1;
    info.enabledApiLayerNames = bogus;
    EXPECT_EQ(try_create(info), XR_SUCCESS) << "layers are the loader's business";
}

TEST(CreateInstance, UnknownAndCircularChainsAreSkipped) {
    XrBaseInStructure first{XrStructureType(77777), nullptr}, second{XrStructureType(88888), &first};
    first.next = &second;
    XrInstanceCreateInfo info = create_info();
    info.next = &first;
    EXPECT_EQ(try_create(info), XR_SUCCESS);
}

TEST(CreateInstance, HostThatIsMissingSaysSo) {
    PFN_xrVoidFunction function = nullptr;
    const auto broken =
        negotiated(+[](const ApplicationIdentity&) -> Result<std::unique_ptr<RuntimeHost>> { return missing("no GPU; install one"); });
    ASSERT_EQ(broken(XR_NULL_HANDLE, "xrCreateInstance", &function), XR_SUCCESS);
    std::string heard;
    XrDebugUtilsMessengerCreateInfoEXT messenger{XR_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
                                                 nullptr,
                                                 0x1111,
                                                 0xf,
                                                 +[](XrDebugUtilsMessageSeverityFlagsEXT, XrDebugUtilsMessageTypeFlagsEXT,
                                                     const XrDebugUtilsMessengerCallbackDataEXT* data, void* user) -> XrBool32 {
                                                     *static_cast<std::string*>(user) += data->message;
                                                     return XR_FALSE;
                                                 },
                                                 &heard};
    XrInstanceCreateInfo info = create_info();
    const char* names[] = {"XR_EXT_debug_utils"};
    info.next = &messenger;
    info.enabledExtensionCount = 1;
    info.enabledExtensionNames = names;
    XrInstance instance = XR_NULL_HANDLE;
    EXPECT_EQ(reinterpret_cast<PFN_xrCreateInstance>(function)(&info, &instance), XR_ERROR_RUNTIME_UNAVAILABLE);
    EXPECT_NE(heard.find("install one"), std::string::npos);
    const auto throwing =
        negotiated(+[](const ApplicationIdentity&) -> Result<std::unique_ptr<RuntimeHost>> { throw std::runtime_error("x"); });
    ASSERT_EQ(throwing(XR_NULL_HANDLE, "xrCreateInstance", &function), XR_SUCCESS);
    EXPECT_EQ(reinterpret_cast<PFN_xrCreateInstance>(function)(&info, &instance), XR_ERROR_RUNTIME_FAILURE);
    negotiated();
}

TEST(Instance, DestroyedHandleIsInvalid) {
    XrInstance stale = XR_NULL_HANDLE;
    PFN_xrGetInstanceProperties get = nullptr;
    PFN_xrDestroyInstance destroy = nullptr;
    {
        Client xr;
        stale = xr.instance;
        get = xr.xrGetInstanceProperties;
        destroy = xr.xrDestroyInstance;
        EXPECT_EQ(xr.host->application.name, "test");
        EXPECT_EQ(xr.host->application.extensions.size(), all_extensions().size());
    }
    XrInstanceProperties properties{XR_TYPE_INSTANCE_PROPERTIES};
    EXPECT_EQ(get(stale, &properties), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(destroy(stale), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(destroy(XR_NULL_HANDLE), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(destroy(reinterpret_cast<XrInstance>(0x1234)), XR_ERROR_HANDLE_INVALID);
}

TEST(TwoCall, Extensions) {
    Client xr;
    std::uint32_t count = 0;
    ASSERT_EQ(xr.xrEnumerateInstanceExtensionProperties(nullptr, 0, &count, nullptr), XR_SUCCESS);
    const std::uint32_t offered = count;
    ASSERT_GE(offered, all_extensions().size());
    EXPECT_EQ(xr.xrEnumerateInstanceExtensionProperties(nullptr, 0, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrEnumerateInstanceExtensionProperties(nullptr, 6, &count, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrEnumerateInstanceExtensionProperties("layer", 0, &count, nullptr), XR_ERROR_API_LAYER_NOT_PRESENT);
    std::vector<XrExtensionProperties> properties(count, {XR_TYPE_EXTENSION_PROPERTIES});
    EXPECT_EQ(xr.xrEnumerateInstanceExtensionProperties(nullptr, 2, &count, properties.data()), XR_ERROR_SIZE_INSUFFICIENT);
    EXPECT_EQ(count, offered);
    ASSERT_EQ(xr.xrEnumerateInstanceExtensionProperties(nullptr, count, &count, properties.data()), XR_SUCCESS);
    std::set<std::string> names;
    for (const XrExtensionProperties& property : properties) {
        EXPECT_TRUE(names.insert(property.extensionName).second) << property.extensionName << " is listed twice";
        EXPECT_GT(property.extensionVersion, 0u) << property.extensionName;
    }
    for (const char* name : all_extensions()) EXPECT_TRUE(names.contains(name)) << name;
    properties[1].type = XR_TYPE_UNKNOWN;
    EXPECT_EQ(xr.xrEnumerateInstanceExtensionProperties(nullptr, count, &count, properties.data()), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrEnumerateApiLayerProperties(0, &count, nullptr), XR_SUCCESS);
    EXPECT_EQ(count, 0u);
}

TEST(Strings, ResultsAndStructureTypes) {
    Client xr;
    char text[XR_MAX_RESULT_STRING_SIZE];
    const auto result = [&](int value) {
        EXPECT_EQ(xr.xrResultToString(xr.instance, static_cast<XrResult>(value), text), XR_SUCCESS);
        return std::string(text);
    };
    EXPECT_EQ(result(XR_ERROR_POSE_INVALID), "XR_ERROR_POSE_INVALID");
    EXPECT_EQ(result(123456), "XR_UNKNOWN_SUCCESS_123456");
    EXPECT_EQ(result(-123456), "XR_UNKNOWN_FAILURE_-123456");
    const auto type = [&](int value) {
        EXPECT_EQ(xr.xrStructureTypeToString(xr.instance, static_cast<XrStructureType>(value), text), XR_SUCCESS);
        return std::string(text);
    };
    EXPECT_EQ(type(XR_TYPE_VIEW), "XR_TYPE_VIEW");
    EXPECT_EQ(type(77777), "XR_UNKNOWN_STRUCTURE_TYPE_77777");
    EXPECT_EQ(xr.xrResultToString(XR_NULL_HANDLE, XR_SUCCESS, text), XR_ERROR_HANDLE_INVALID);
}

TEST(Paths, ThroughTheApi) {
    Client xr;
    XrPath path = XR_NULL_PATH;
    EXPECT_EQ(xr.xrStringToPath(xr.instance, "/Bad", &path), XR_ERROR_PATH_FORMAT_INVALID);
    EXPECT_EQ(xr.xrStringToPath(xr.instance, nullptr, &path), XR_ERROR_VALIDATION_FAILURE);
    ASSERT_EQ(xr.xrStringToPath(xr.instance, "/good/path", &path), XR_SUCCESS);
    std::uint32_t count = 0;
    char text[XR_MAX_PATH_LENGTH];
    EXPECT_EQ(xr.xrPathToString(xr.instance, path, 0, &count, nullptr), XR_SUCCESS);
    EXPECT_EQ(count, 11u);
    EXPECT_EQ(xr.xrPathToString(xr.instance, path, 4, &count, text), XR_ERROR_SIZE_INSUFFICIENT);
    EXPECT_EQ(xr.xrPathToString(xr.instance, XR_NULL_PATH, 4, &count, text), XR_ERROR_PATH_INVALID);
    EXPECT_EQ(xr.text(path), "/good/path");
}

TEST(System, OneHeadset) {
    Client xr;
    XrSystemGetInfo info{XR_TYPE_SYSTEM_GET_INFO, nullptr, XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
    XrSystemId system = XR_NULL_SYSTEM_ID;
    ASSERT_EQ(xr.xrGetSystem(xr.instance, &info, &system), XR_SUCCESS);
    XrSystemEyeGazeInteractionPropertiesEXT gaze{XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT};
    XrSystemProperties properties{XR_TYPE_SYSTEM_PROPERTIES, &gaze};
    ASSERT_EQ(xr.xrGetSystemProperties(xr.instance, system, &properties), XR_SUCCESS);
    EXPECT_STREQ(properties.systemName, "Fake headset");
    EXPECT_EQ(properties.graphicsProperties.maxLayerCount, max_layers);
    EXPECT_EQ(gaze.supportsEyeGazeInteraction, XR_TRUE);
    xr.host->eyes.is_present = false;
    ASSERT_EQ(xr.xrGetSystemProperties(xr.instance, system, &properties), XR_SUCCESS);
    EXPECT_EQ(gaze.supportsEyeGazeInteraction, XR_FALSE);
    EXPECT_EQ(xr.xrGetSystemProperties(xr.instance, XR_NULL_SYSTEM_ID, &properties), XR_ERROR_SYSTEM_INVALID);
    info.formFactor = XR_FORM_FACTOR_HANDHELD_DISPLAY;
    EXPECT_EQ(xr.xrGetSystem(xr.instance, &info, &system), XR_ERROR_FORM_FACTOR_UNSUPPORTED);
    info.formFactor = XR_FORM_FACTOR_MAX_ENUM;
    EXPECT_EQ(xr.xrGetSystem(xr.instance, &info, &system), XR_ERROR_FORM_FACTOR_UNSUPPORTED);
}

TEST(System, ViewConfigurations) {
    Client xr;
    std::uint32_t count = 0;
    XrViewConfigurationType type{};
    ASSERT_EQ(xr.xrEnumerateViewConfigurations(xr.instance, 1, 1, &count, &type), XR_SUCCESS);
    EXPECT_EQ(type, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO);
    XrViewConfigurationProperties properties{XR_TYPE_VIEW_CONFIGURATION_PROPERTIES};
    EXPECT_EQ(xr.xrGetViewConfigurationProperties(xr.instance, 1, type, &properties), XR_SUCCESS);
    EXPECT_EQ(xr.xrGetViewConfigurationProperties(xr.instance, 1, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_MONO, &properties),
              XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED);
    EXPECT_EQ(xr.xrGetViewConfigurationProperties(xr.instance, 1, XrViewConfigurationType(999), &properties), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrGetViewConfigurationProperties(xr.instance, 2, type, &properties), XR_ERROR_SYSTEM_INVALID);
    std::vector<XrViewConfigurationView> views(2, {XR_TYPE_VIEW_CONFIGURATION_VIEW});
    EXPECT_EQ(xr.xrEnumerateViewConfigurationViews(xr.instance, 1, type, 1, &count, views.data()), XR_ERROR_SIZE_INSUFFICIENT);
    ASSERT_EQ(xr.xrEnumerateViewConfigurationViews(xr.instance, 1, type, 2, &count, views.data()), XR_SUCCESS);
    EXPECT_EQ(views[1].recommendedImageRectWidth, 256u);
    EXPECT_EQ(views[1].recommendedImageRectHeight, 288u);
    views[0].type = XR_TYPE_UNKNOWN;
    EXPECT_EQ(xr.xrEnumerateViewConfigurationViews(xr.instance, 1, type, 2, &count, views.data()), XR_ERROR_VALIDATION_FAILURE);
    XrEnvironmentBlendMode mode{};
    ASSERT_EQ(xr.xrEnumerateEnvironmentBlendModes(xr.instance, 1, type, 1, &count, &mode), XR_SUCCESS);
    EXPECT_EQ(mode, XR_ENVIRONMENT_BLEND_MODE_OPAQUE);
}

TEST(Timespec, IsTheSameNumber) {
    Client xr;
    const auto to_time = xr.get<PFN_xrConvertTimespecTimeToTimeKHR>("xrConvertTimespecTimeToTimeKHR");
    const auto to_timespec = xr.get<PFN_xrConvertTimeToTimespecTimeKHR>("xrConvertTimeToTimespecTimeKHR");
    timespec spec{3, 5};
    XrTime time = 0;
    ASSERT_EQ(to_time(xr.instance, &spec, &time), XR_SUCCESS);
    EXPECT_EQ(time, 3'000'000'005);
    spec = {};
    ASSERT_EQ(to_timespec(xr.instance, time, &spec), XR_SUCCESS);
    EXPECT_EQ(spec.tv_sec, 3);
    EXPECT_EQ(spec.tv_nsec, 5);
    EXPECT_EQ(to_timespec(xr.instance, 0, &spec), XR_ERROR_TIME_INVALID);
    EXPECT_EQ(to_timespec(xr.instance, -5, &spec), XR_ERROR_TIME_INVALID);
    for (const timespec bad : {timespec{0, 0}, timespec{-1, 0}, timespec{1, ns_per_s}, timespec{1, -1}, timespec{INT64_MAX, 0}}) {
        EXPECT_EQ(to_time(xr.instance, &bad, &time), XR_ERROR_TIME_INVALID);
    }
    EXPECT_EQ(to_time(xr.instance, nullptr, &time), XR_ERROR_VALIDATION_FAILURE);
}

struct Heard {
    std::vector<std::string> messages, functions, objects;
};
XrBool32 XRAPI_CALL hear(XrDebugUtilsMessageSeverityFlagsEXT, XrDebugUtilsMessageTypeFlagsEXT,
                         const XrDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    auto& heard = *static_cast<Heard*>(user);
    heard.messages.emplace_back(data->message ? data->message : "");
    heard.functions.emplace_back(data->functionName ? data->functionName : "");
    for (std::uint32_t i = 0; i < data->objectCount; ++i)
        heard.objects.emplace_back(data->objects[i].objectName ? data->objects[i].objectName : "");
    return XR_FALSE;
}

TEST(DebugUtils, EveryErrorIsToldInASentence) {
    Client xr;
    Heard heard;
    const XrDebugUtilsMessengerCreateInfoEXT info{
        XR_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,  nullptr, XR_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        XR_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT, &hear,   &heard};
    XrDebugUtilsMessengerEXT messenger = XR_NULL_HANDLE;
    const auto create = xr.get<PFN_xrCreateDebugUtilsMessengerEXT>("xrCreateDebugUtilsMessengerEXT");
    ASSERT_EQ(create(xr.instance, &info, &messenger), XR_SUCCESS);
    XrSystemProperties properties{XR_TYPE_SYSTEM_PROPERTIES};
    EXPECT_EQ(xr.xrGetSystemProperties(xr.instance, 42, &properties), XR_ERROR_SYSTEM_INVALID);
    ASSERT_EQ(heard.messages.size(), 1u);
    EXPECT_EQ(heard.functions[0], "xrGetSystemProperties");
    EXPECT_NE(heard.messages[0].find("xrGetSystem"), std::string::npos);
    EXPECT_NE(heard.messages[0].find("XR_ERROR_SYSTEM_INVALID"), std::string::npos);
    ASSERT_EQ(xr.get<PFN_xrDestroyDebugUtilsMessengerEXT>("xrDestroyDebugUtilsMessengerEXT")(messenger), XR_SUCCESS);
    EXPECT_EQ(xr.xrGetSystemProperties(xr.instance, 42, &properties), XR_ERROR_SYSTEM_INVALID);
    EXPECT_EQ(heard.messages.size(), 1u);
    XrDebugUtilsMessengerCreateInfoEXT bad = info;
    bad.userCallback = nullptr;
    EXPECT_EQ(create(xr.instance, &bad, &messenger), XR_ERROR_VALIDATION_FAILURE);
    bad = info;
    bad.messageSeverities = 0;
    EXPECT_EQ(create(xr.instance, &bad, &messenger), XR_ERROR_VALIDATION_FAILURE);
}

TEST(DebugUtils, NamesOfObjectsAreFilledIn) {
    Heard heard;
    const XrDebugUtilsMessengerCreateInfoEXT info{XR_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT, nullptr, 0x1111, 0xf, &hear, &heard};
    Client xr(all_extensions(), &info);
    XrDebugUtilsMessengerEXT messenger = XR_NULL_HANDLE;
    ASSERT_EQ(xr.get<PFN_xrCreateDebugUtilsMessengerEXT>("xrCreateDebugUtilsMessengerEXT")(xr.instance, &info, &messenger), XR_SUCCESS);
    const auto set_name = xr.get<PFN_xrSetDebugUtilsObjectNameEXT>("xrSetDebugUtilsObjectNameEXT");
    const auto handle = reinterpret_cast<std::uint64_t>(xr.instance);
    XrDebugUtilsObjectNameInfoEXT name{XR_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT, nullptr, XR_OBJECT_TYPE_INSTANCE, handle, "my instance"};
    ASSERT_EQ(set_name(xr.instance, &name), XR_SUCCESS);
    XrDebugUtilsObjectNameInfoEXT object{XR_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT, nullptr, XR_OBJECT_TYPE_INSTANCE, handle, nullptr};
    XrDebugUtilsMessengerCallbackDataEXT data{XR_TYPE_DEBUG_UTILS_MESSENGER_CALLBACK_DATA_EXT};
    data.message = "hello";
    data.objectCount = 1;
    data.objects = &object;
    const auto submit = xr.get<PFN_xrSubmitDebugUtilsMessageEXT>("xrSubmitDebugUtilsMessageEXT");
    ASSERT_EQ(submit(xr.instance, XR_DEBUG_UTILS_MESSAGE_SEVERITY_INFO_BIT_EXT, XR_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT, &data),
              XR_SUCCESS);
    ASSERT_EQ(heard.objects.size(), 1u) << "the chained messenger is the loader's to go on with";
    EXPECT_EQ(heard.objects[0], "my instance");
    object.objectHandle = 77;
    object.objectName = "named by the message";
    ASSERT_EQ(submit(xr.instance, XR_DEBUG_UTILS_MESSAGE_SEVERITY_INFO_BIT_EXT, XR_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT, &data),
              XR_SUCCESS);
    EXPECT_EQ(heard.objects.back(), "named by the message");
    name.objectHandle = 0;
    EXPECT_EQ(set_name(xr.instance, &name), XR_ERROR_HANDLE_INVALID);
}

}  // namespace
}  // namespace entoptic::runtime::testing
