// XR_EXT_debug_utils.
#include "runtime/objects/debug_utils.h"

#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/verify.h"
#include "runtime/objects/session.h"

namespace entoptic::runtime::api {

namespace {

constexpr XrDebugUtilsMessageSeverityFlagsEXT known_severities = 0x1111;
constexpr XrDebugUtilsMessageTypeFlagsEXT known_types = 0xf;
constexpr std::uint32_t most_objects = 1024;

Outcome check_flags(XrDebugUtilsMessageSeverityFlagsEXT severities, XrDebugUtilsMessageTypeFlagsEXT types) {
    if (severities == 0 || (severities & ~known_severities) != 0) return invalid("the severities {:#x} are none or unknown", severities);
    if (types == 0 || (types & ~known_types) != 0) return invalid("the message types {:#x} are none or unknown", types);
    return XR_SUCCESS;
}

Outcome check_label(const XrDebugUtilsLabelEXT* label) {
    ENTOPTIC_XR_TRY(require(label, XR_TYPE_DEBUG_UTILS_LABEL_EXT, "labelInfo"));
    return require_pointer(label->labelName, "labelInfo->labelName");
}

Outcome read_objects(const XrDebugUtilsMessengerCallbackDataEXT& data, std::vector<DebugObject>& objects) {
    if (data.objectCount == 0) return XR_SUCCESS;
    ENTOPTIC_XR_TRY(require_pointer(data.objects, "callbackData->objects"));
    if (data.objectCount > most_objects) return invalid("{} objects are more than {}", data.objectCount, most_objects);
    for (std::uint32_t i = 0; i < data.objectCount; ++i) {
        const XrDebugUtilsObjectNameInfoEXT& given = data.objects[i];
        objects.push_back({given.objectType, given.objectHandle, given.objectName ? given.objectName : ""});
    }
    return XR_SUCCESS;
}

}  // namespace

XrResult XRAPI_CALL set_debug_utils_object_name(XrInstance handle, const XrDebugUtilsObjectNameInfoEXT* info) {
    return call("xrSetDebugUtilsObjectNameEXT", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT, "nameInfo"));
        if (info->objectType == XR_OBJECT_TYPE_UNKNOWN) return invalid("nameInfo->objectType is XR_OBJECT_TYPE_UNKNOWN");
        if (info->objectHandle == 0) return error(XR_ERROR_HANDLE_INVALID, "nameInfo->objectHandle is XR_NULL_HANDLE");
        instance->debug().set_name({info->objectType, info->objectHandle}, info->objectName);
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL create_debug_utils_messenger(XrInstance handle, const XrDebugUtilsMessengerCreateInfoEXT* info,
                                                 XrDebugUtilsMessengerEXT* messenger_handle) {
    return call("xrCreateDebugUtilsMessengerEXT", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT, "createInfo"));
        ENTOPTIC_XR_TRY(require_pointer(messenger_handle, "messenger"));
        ENTOPTIC_XR_TRY(check_flags(info->messageSeverities, info->messageTypes));
        if (!info->userCallback) return invalid("createInfo->userCallback is null");
        auto messenger = std::make_shared<Messenger>(instance, *info);
        ENTOPTIC_XR_TRY(publish(messenger, handle_value(handle), messenger_handle));
        instance->debug().add(messenger.get());
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL destroy_debug_utils_messenger(XrDebugUtilsMessengerEXT handle) {
    return call("xrDestroyDebugUtilsMessengerEXT", handle, [&] { return destroy<Messenger>(handle_value(handle)); });
}

XrResult XRAPI_CALL submit_debug_utils_message(XrInstance handle, XrDebugUtilsMessageSeverityFlagsEXT severity,
                                               XrDebugUtilsMessageTypeFlagsEXT types, const XrDebugUtilsMessengerCallbackDataEXT* data) {
    return call("xrSubmitDebugUtilsMessageEXT", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require(data, XR_TYPE_DEBUG_UTILS_MESSENGER_CALLBACK_DATA_EXT, "callbackData"));
        ENTOPTIC_XR_TRY(check_flags(severity, types));
        std::vector<DebugObject> objects;
        ENTOPTIC_XR_TRY(read_objects(*data, objects));
        instance->debug().submit(severity, types, data->messageId, data->functionName, data->message, objects);
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL session_begin_debug_utils_label_region(XrSession handle, const XrDebugUtilsLabelEXT* label) {
    return call("xrSessionBeginDebugUtilsLabelRegionEXT", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(check_label(label));
        session->instance().debug().begin_region(handle_value(handle), label->labelName);
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL session_end_debug_utils_label_region(XrSession handle) {
    return call("xrSessionEndDebugUtilsLabelRegionEXT", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        session->instance().debug().end_region(handle_value(handle));
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL session_insert_debug_utils_label(XrSession handle, const XrDebugUtilsLabelEXT* label) {
    return call("xrSessionInsertDebugUtilsLabelEXT", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(check_label(label));
        session->instance().debug().insert_label(handle_value(handle), label->labelName);
        return XR_SUCCESS;
    });
}

}  // namespace entoptic::runtime::api
