// The frame loop, and layers as the application gives them.
#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/layers.h"
#include "runtime/api/verify.h"
#include "runtime/objects/session.h"

namespace entoptic::runtime::api {

namespace {

Outcome check_blend_mode(XrEnvironmentBlendMode mode) {
    switch (mode) {
        case XR_ENVIRONMENT_BLEND_MODE_OPAQUE:
            return XR_SUCCESS;
        case XR_ENVIRONMENT_BLEND_MODE_ADDITIVE:
        case XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND:
            return error(XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED, "only XR_ENVIRONMENT_BLEND_MODE_OPAQUE is offered");
        default:
            return invalid("{} is not an environment blend mode", static_cast<int>(mode));
    }
}

}  // namespace

XrResult XRAPI_CALL wait_frame(XrSession handle, const XrFrameWaitInfo* info, XrFrameState* state) {
    return call("xrWaitFrame", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(optional(info, XR_TYPE_FRAME_WAIT_INFO, "frameWaitInfo"));
        ENTOPTIC_XR_TRY(require(state, XR_TYPE_FRAME_STATE, "frameState"));
        return session->wait_frame(*state);
    });
}

XrResult XRAPI_CALL begin_frame(XrSession handle, const XrFrameBeginInfo* info) {
    return call("xrBeginFrame", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(optional(info, XR_TYPE_FRAME_BEGIN_INFO, "frameBeginInfo"));
        return session->begin_frame();
    });
}

XrResult XRAPI_CALL end_frame(XrSession handle, const XrFrameEndInfo* info) {
    return call("xrEndFrame", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_FRAME_END_INFO, "frameEndInfo"));
        return session->end_frame([&](FrameSubmission& submission) -> Outcome {
            ENTOPTIC_XR_TRY(check_time(info->displayTime));
            ENTOPTIC_XR_TRY(check_blend_mode(info->environmentBlendMode));
            submission.display_time = info->displayTime;
            // A session without graphics has no swapchains that its layers could name, and nothing is composed: they are not looked at, so
            // that a frame loop written for any session runs in it.
            if (!session->graphics()) return {};
            return resolve_layers(session, *info, submission.layers);
        });
    });
}

}  // namespace entoptic::runtime::api
