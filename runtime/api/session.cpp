// Sessions and their states.
#include "runtime/objects/session.h"

#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/verify.h"
#include "runtime/graphics/bindings.h"

namespace entoptic::runtime::api {

namespace {

// Frees the instance's only session again unless the session came to be.
class SessionClaim {
public:
    explicit SessionClaim(Instance& instance) : instance_(instance), held_(instance.claim_session()) {}
    ~SessionClaim() {
        if (held_) instance_.free_session();
    }
    SessionClaim(const SessionClaim&) = delete;
    SessionClaim& operator=(const SessionClaim&) = delete;
    bool held() const { return held_; }
    void keep() { held_ = false; }

private:
    Instance& instance_;
    bool held_;
};

}  // namespace

XrResult XRAPI_CALL create_session(XrInstance handle, const XrSessionCreateInfo* info, XrSession* session_handle) {
    return call("xrCreateSession", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_SESSION_CREATE_INFO, "createInfo"));
        ENTOPTIC_XR_TRY(require_pointer(session_handle, "session"));
        if (info->createFlags != 0) return invalid("createInfo->createFlags must be 0");
        ENTOPTIC_XR_TRY(check_system(info->systemId));
        std::unique_ptr<GraphicsDevice> graphics;
        const bool headless = instance->enabled(XR_MND_HEADLESS_EXTENSION_NAME) && !graphics::has_graphics_binding(info->next);
        if (!headless) ENTOPTIC_XR_TRY(graphics::make_graphics_device(*instance, info->next, graphics));
        SessionClaim claim(*instance);
        if (!claim.held()) return error(XR_ERROR_LIMIT_REACHED, "this instance has a session already; destroy it first");
        auto session = std::make_shared<Session>(instance, std::move(graphics));
        ENTOPTIC_XR_TRY(publish(session, handle_value(handle), session_handle));
        claim.keep();
        session->announce();
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL destroy_session(XrSession handle) {
    return call("xrDestroySession", handle, [&] { return destroy<Session>(handle_value(handle)); });
}

XrResult XRAPI_CALL begin_session(XrSession handle, const XrSessionBeginInfo* info) {
    return call("xrBeginSession", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_SESSION_BEGIN_INFO, "beginInfo"));
        ENTOPTIC_XR_TRY(check_view_configuration(session->instance(), info->primaryViewConfigurationType));
        return session->begin(info->primaryViewConfigurationType);
    });
}

XrResult XRAPI_CALL end_session(XrSession handle) {
    return call("xrEndSession", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        return session->end();
    });
}

XrResult XRAPI_CALL request_exit_session(XrSession handle) {
    return call("xrRequestExitSession", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        return session->request_exit();
    });
}

}  // namespace entoptic::runtime::api
