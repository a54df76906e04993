// Instances, events, paths and names of enumerants.
#include "runtime/objects/instance.h"

#include "base/log.h"
#include "runtime/api/call.h"
#include "runtime/api/extensions.h"
#include "runtime/api/functions.h"
#include "runtime/api/limits.h"
#include "runtime/api/structure_names.h"
#include "runtime/api/verify.h"
#include "runtime/runtime.h"

#include <algorithm>
#include <atomic>

namespace entoptic::runtime {

namespace {

std::atomic<RuntimeHostFactory> host_factory{nullptr};

bool offered(std::string_view name) {
    const auto all = api::extensions();
    return std::any_of(all.begin(), all.end(), [&](const api::Extension& extension) { return extension.name == name; });
}

Outcome check_api_version(XrVersion version) {
    if (XR_VERSION_MAJOR(version) == 1 && XR_VERSION_MINOR(version) <= 1) return XR_SUCCESS;
    return error(XR_ERROR_API_VERSION_UNSUPPORTED, "the application asks for OpenXR {}.{}.{}; this runtime has 1.0 and 1.1",
                 XR_VERSION_MAJOR(version), XR_VERSION_MINOR(version), XR_VERSION_PATCH(version));
}

// XR_ERROR_EXTENSION_DEPENDENCY_NOT_ENABLED.
Outcome check_dependencies(const std::vector<std::string>& extensions) {
    const auto has = [&](std::string_view name) { return std::find(extensions.begin(), extensions.end(), name) != extensions.end(); };
    for (const api::Extension& extension : api::extensions()) {
        if (!extension.needs || !has(extension.name) || has(extension.needs)) continue;
        return error(XR_ERROR_EXTENSION_DEPENDENCY_NOT_ENABLED, "{} needs {}; enable both", extension.name, extension.needs);
    }
    return XR_SUCCESS;
}

Outcome read_extensions(const XrInstanceCreateInfo& info, std::vector<std::string>& extensions) {
    if (info.enabledExtensionCount == 0) return XR_SUCCESS;
    ENTOPTIC_XR_TRY(api::require_pointer(info.enabledExtensionNames, "createInfo->enabledExtensionNames"));
    for (std::uint32_t i = 0; i < info.enabledExtensionCount; ++i) {
        ENTOPTIC_XR_TRY(api::require_pointer(info.enabledExtensionNames[i], "an extension name"));
        const std::string name(info.enabledExtensionNames[i], strnlen(info.enabledExtensionNames[i], XR_MAX_EXTENSION_NAME_SIZE));
        if (!offered(name)) return error(XR_ERROR_EXTENSION_NOT_PRESENT, "this runtime has no extension \"{}\"", name);
        if (std::find(extensions.begin(), extensions.end(), name) == extensions.end()) extensions.push_back(name);
    }
    return check_dependencies(extensions);
}

Outcome read_application(const XrInstanceCreateInfo& info, ApplicationIdentity& application) {
    const XrApplicationInfo& given = info.applicationInfo;
    application.name = api::bounded_text(given.applicationName);
    if (application.name.empty()) return error(XR_ERROR_NAME_INVALID, "applicationName is empty or not terminated");
    if (strnlen(given.engineName, XR_MAX_ENGINE_NAME_SIZE) == XR_MAX_ENGINE_NAME_SIZE) {
        return error(XR_ERROR_NAME_INVALID, "engineName is not terminated");
    }
    application.engine = given.engineName;
    application.application_version = given.applicationVersion;
    application.engine_version = given.engineVersion;
    application.api_version = given.apiVersion;
    return read_extensions(info, application.extensions);
}

Outcome make_host(Instance& instance) {
    const RuntimeHostFactory factory = host_factory.load();
    if (!factory) return error(XR_ERROR_RUNTIME_FAILURE, "the runtime was not loaded by the OpenXR loader");
    auto host = factory(instance.application());
    if (!host) {
        log::error("{}", host.error().message);
        const bool is_missing = host.error().kind == ErrorKind::missing;
        return {is_missing ? XR_ERROR_RUNTIME_UNAVAILABLE : XR_ERROR_RUNTIME_FAILURE, host.error().message};
    }
    instance.set_host(std::move(*host));
    return XR_SUCCESS;
}

// The new instance has no handle yet, so its messengers are told here.
Outcome make_host_or_tell(Instance& instance) {
    const Outcome made = make_host(instance);
    if (made.failed()) {
        instance.debug().submit(XR_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT, XR_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT,
                                api::result_name(made.code()), "xrCreateInstance", made.message().c_str(), {});
    }
    return made;
}

}  // namespace

XrResult negotiate(const XrNegotiateLoaderInfo* info, XrNegotiateRuntimeRequest* request, RuntimeHostFactory factory) noexcept {
    if (!info || info->structType != XR_LOADER_INTERFACE_STRUCT_LOADER_INFO || info->structVersion != XR_LOADER_INFO_STRUCT_VERSION ||
        info->structSize != sizeof(XrNegotiateLoaderInfo)) {
        return XR_ERROR_INITIALIZATION_FAILED;
    }
    if (!request || request->structType != XR_LOADER_INTERFACE_STRUCT_RUNTIME_REQUEST ||
        request->structVersion != XR_RUNTIME_INFO_STRUCT_VERSION || request->structSize != sizeof(XrNegotiateRuntimeRequest)) {
        return XR_ERROR_INITIALIZATION_FAILED;
    }
    const bool same_interface =
        info->minInterfaceVersion <= XR_CURRENT_LOADER_RUNTIME_VERSION && info->maxInterfaceVersion >= XR_CURRENT_LOADER_RUNTIME_VERSION;
    const bool same_api = info->minApiVersion <= api::runtime_api_version && XR_VERSION_MAJOR(info->maxApiVersion) >= 1;
    if (!same_interface || !same_api || !factory) return XR_ERROR_INITIALIZATION_FAILED;
    host_factory = factory;
    request->runtimeInterfaceVersion = XR_CURRENT_LOADER_RUNTIME_VERSION;
    request->runtimeApiVersion = api::runtime_api_version;
    request->getInstanceProcAddr = get_instance_proc_addr;
    return XR_SUCCESS;
}

namespace api {

XrResult XRAPI_CALL enumerate_api_layer_properties(uint32_t capacity, uint32_t* count, XrApiLayerProperties* properties) {
    return call("xrEnumerateApiLayerProperties", XrInstance(XR_NULL_HANDLE), [&]() -> Outcome {
        bool fill = false;
        return two_call(capacity, count, properties, 0, fill);  // layers are the loader's
    });
}

XrResult XRAPI_CALL enumerate_instance_extension_properties(const char* layer, uint32_t capacity, uint32_t* count,
                                                            XrExtensionProperties* properties) {
    return call("xrEnumerateInstanceExtensionProperties", XrInstance(XR_NULL_HANDLE), [&]() -> Outcome {
        if (layer && *layer) return error(XR_ERROR_API_LAYER_NOT_PRESENT, "a runtime has no API layers");
        bool fill = false;
        const auto all = extensions();
        ENTOPTIC_XR_TRY(two_call(capacity, count, properties, all.size(), fill));
        if (!fill) return XR_SUCCESS;
        for (std::size_t i = 0; i < all.size(); ++i) {
            ENTOPTIC_XR_TRY(require(&properties[i], XR_TYPE_EXTENSION_PROPERTIES, "properties"));
        }
        for (std::size_t i = 0; i < all.size(); ++i) {
            std::memset(properties[i].extensionName, 0, sizeof(properties[i].extensionName));
            std::strncpy(properties[i].extensionName, all[i].name, sizeof(properties[i].extensionName) - 1);
            properties[i].extensionVersion = all[i].version;
        }
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL create_instance(const XrInstanceCreateInfo* info, XrInstance* handle) {
    return call("xrCreateInstance", XrInstance(XR_NULL_HANDLE), [&]() -> Outcome {
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_INSTANCE_CREATE_INFO, "createInfo"));
        ENTOPTIC_XR_TRY(require_pointer(handle, "instance"));
        ENTOPTIC_XR_TRY(check_api_version(info->applicationInfo.apiVersion));
        if (info->createFlags != 0) return invalid("createInfo->createFlags must be 0");
        // The loader hands the application's list of API layers on as it is, and has checked it: it means nothing here.
        ApplicationIdentity application;
        ENTOPTIC_XR_TRY(read_application(*info, application));
        auto instance = std::make_shared<Instance>(std::move(application));
        const auto* messenger = chained<XrDebugUtilsMessengerCreateInfoEXT>(info->next, XR_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
        if (messenger && instance->enabled(XR_EXT_DEBUG_UTILS_EXTENSION_NAME) && messenger->userCallback)
            instance->debug().add_for_creation(*messenger);
        ENTOPTIC_XR_TRY(make_host_or_tell(*instance));
        instance->debug().creation_done();
        return publish(instance, 0, handle);
    });
}

XrResult XRAPI_CALL destroy_instance(XrInstance handle) {
    return call("xrDestroyInstance", handle, [&] { return destroy<Instance>(handle_value(handle)); });
}

XrResult XRAPI_CALL get_instance_properties(XrInstance handle, XrInstanceProperties* properties) {
    return call("xrGetInstanceProperties", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require(properties, XR_TYPE_INSTANCE_PROPERTIES, "instanceProperties"));
        unsigned major = 0, minor = 0, patch = 0;
        std::sscanf(ENTOPTIC_VERSION, "%u.%u.%u", &major, &minor, &patch);
        properties->runtimeVersion = XR_MAKE_VERSION(major, minor, patch);
        std::memset(properties->runtimeName, 0, sizeof(properties->runtimeName));
        std::strncpy(properties->runtimeName, "Entoptic", sizeof(properties->runtimeName) - 1);
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL poll_event(XrInstance handle, XrEventDataBuffer* event) {
    return call("xrPollEvent", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require(event, XR_TYPE_EVENT_DATA_BUFFER, "eventData"));
        return instance->events().poll(*event);
    });
}

XrResult XRAPI_CALL result_to_string(XrInstance handle, XrResult value, char* buffer) {
    return call("xrResultToString", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require_pointer(buffer, "buffer"));
        const char* name = result_name(value);
        const std::string text = name               ? std::string(name)
                                 : XR_FAILED(value) ? fmt::format("XR_UNKNOWN_FAILURE_{}", static_cast<int>(value))
                                                    : fmt::format("XR_UNKNOWN_SUCCESS_{}", static_cast<int>(value));
        std::strncpy(buffer, text.c_str(), XR_MAX_RESULT_STRING_SIZE - 1);
        buffer[XR_MAX_RESULT_STRING_SIZE - 1] = 0;
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL structure_type_to_string(XrInstance handle, XrStructureType value, char* buffer) {
    return call("xrStructureTypeToString", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require_pointer(buffer, "buffer"));
        const char* name = structure_name(value);
        const std::string text = name ? std::string(name) : fmt::format("XR_UNKNOWN_STRUCTURE_TYPE_{}", static_cast<int>(value));
        std::strncpy(buffer, text.c_str(), XR_MAX_STRUCTURE_NAME_SIZE - 1);
        buffer[XR_MAX_STRUCTURE_NAME_SIZE - 1] = 0;
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL string_to_path(XrInstance handle, const char* text, XrPath* path) {
    return call("xrStringToPath", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require_pointer(text, "pathString"));
        ENTOPTIC_XR_TRY(require_pointer(path, "path"));
        return instance->paths().from_string(std::string_view(text, strnlen(text, XR_MAX_PATH_LENGTH)), *path);
    });
}

XrResult XRAPI_CALL path_to_string(XrInstance handle, XrPath path, uint32_t capacity, uint32_t* count, char* buffer) {
    return call("xrPathToString", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        std::string text;
        ENTOPTIC_XR_TRY(instance->paths().to_string(path, text));
        return two_call_string(capacity, count, buffer, text);
    });
}

}  // namespace api

}  // namespace entoptic::runtime
