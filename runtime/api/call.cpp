#include "runtime/api/call.h"

#include "base/log.h"
#include "runtime/api/structure_names.h"
#include "runtime/objects/instance.h"

namespace entoptic::runtime::api {

namespace {

XrObjectType xr_type(ObjectType type) {
    switch (type) {
        case ObjectType::instance:
            return XR_OBJECT_TYPE_INSTANCE;
        case ObjectType::session:
            return XR_OBJECT_TYPE_SESSION;
        case ObjectType::space:
            return XR_OBJECT_TYPE_SPACE;
        case ObjectType::action_set:
            return XR_OBJECT_TYPE_ACTION_SET;
        case ObjectType::action:
            return XR_OBJECT_TYPE_ACTION;
        case ObjectType::swapchain:
            return XR_OBJECT_TYPE_SWAPCHAIN;
        case ObjectType::messenger:
            return XR_OBJECT_TYPE_DEBUG_UTILS_MESSENGER_EXT;
        case ObjectType::none:
            break;
    }
    return XR_OBJECT_TYPE_UNKNOWN;
}

const char* advice(XrResult result) {
    switch (result) {
        case XR_ERROR_OUT_OF_MEMORY:
            return "there is no memory left; destroy swapchains or other objects that are not needed";
        case XR_ERROR_RUNTIME_FAILURE:
            return "the runtime failed; run with ENTOPTIC_LOG=debug and report what it says";
        default:
            return "see the specification of this function";
    }
}

}  // namespace

void report_error(const char* function, std::uint64_t handle, const Outcome& outcome) noexcept {
    // The loader and engines probe xrGetInstanceProcAddr for hundreds of names: that is a question, not a mistake.
    if (outcome.code() == XR_ERROR_FUNCTION_UNSUPPORTED) return;
    try {
        const char* name = result_name(outcome.code());
        const std::string message =
            fmt::format("{}: {} ({})", function, outcome.message().empty() ? advice(outcome.code()) : outcome.message(),
                        name ? name : "unknown result");
        log::info("{}", message);
        const auto object = HandleTable::global().find(handle);
        if (!object) return;
        object->instance().debug().submit(XR_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT, XR_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
                                          name ? name : "XR_ERROR", function, message.c_str(), {{xr_type(object->type()), handle, {}}});
    } catch (...) {
        // No memory even for the message: the code the caller gets says it.
    }
}

}  // namespace entoptic::runtime::api
