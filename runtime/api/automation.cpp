// XR_EXT_conformance_automation: the application plays the input devices itself.
#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/paths.h"
#include "runtime/api/verify.h"
#include "runtime/objects/action_input.h"
#include "runtime/objects/session.h"
#include "runtime/objects/space.h"

#include <cmath>

namespace entoptic::runtime::api {

namespace {

// A component below the top level path, of any profile that the application may use: XR_ERROR_PATH_INVALID, XR_ERROR_PATH_UNSUPPORTED.
Outcome read_source(Instance& instance, XrPath top_level, XrPath source, std::string& text) {
    UserPath user{};
    ENTOPTIC_XR_TRY(to_user_path(instance, top_level, user));
    ENTOPTIC_XR_TRY(instance.paths().to_string(source, text));
    const auto split = split_binding_path(text);
    if (split && split->user == user) return XR_SUCCESS;
    return error(XR_ERROR_PATH_UNSUPPORTED, "{} is not an input below {}", text, user_path_text(user));
}

XrResult set_value(const char* function, XrSession handle, XrPath top_level, XrPath source, ComponentValue value) {
    return call(function, handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        std::string path;
        ENTOPTIC_XR_TRY(read_source(session->instance(), top_level, source, path));
        if (!std::isfinite(value.x) || !std::isfinite(value.y)) return invalid("the state of {} must be finite", path);
        session->input().overrides().set_value(path, value);
        return XR_SUCCESS;
    });
}

}  // namespace

XrResult XRAPI_CALL set_input_device_active(XrSession handle, XrPath profile_path, XrPath top_level, XrBool32 active) {
    return call("xrSetInputDeviceActiveEXT", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        const Profile* profile = nullptr;
        UserPath user{};
        ENTOPTIC_XR_TRY(find_interaction_profile(session->instance(), profile_path, profile));
        ENTOPTIC_XR_TRY(to_user_path(session->instance(), top_level, user));
        if (!profile->serves(user)) return error(XR_ERROR_PATH_UNSUPPORTED, "{} has nothing at {}", profile->path, user_path_text(user));
        session->input().overrides().set_active(user, *profile, active == XR_TRUE);
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL set_input_device_state_bool(XrSession session, XrPath top_level, XrPath source, XrBool32 state) {
    return set_value("xrSetInputDeviceStateBoolEXT", session, top_level, source, {state == XR_TRUE ? 1.0f : 0.0f, 0});
}

XrResult XRAPI_CALL set_input_device_state_float(XrSession session, XrPath top_level, XrPath source, float state) {
    return set_value("xrSetInputDeviceStateFloatEXT", session, top_level, source, {state, 0});
}

XrResult XRAPI_CALL set_input_device_state_vector2f(XrSession session, XrPath top_level, XrPath source, XrVector2f state) {
    return set_value("xrSetInputDeviceStateVector2fEXT", session, top_level, source, {state.x, state.y});
}

XrResult XRAPI_CALL set_input_device_location(XrSession handle, XrPath top_level, XrPath source, XrSpace space_handle, XrPosef pose) {
    return call("xrSetInputDeviceLocationEXT", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        std::shared_ptr<Space> space;
        ENTOPTIC_XR_TRY(find(handle, session));
        std::string path;
        ENTOPTIC_XR_TRY(read_source(session->instance(), top_level, source, path));
        ENTOPTIC_XR_TRY(find(space_handle, space));
        if (space->session() != session) return invalid("the space belongs to another session");
        ENTOPTIC_XR_TRY(check_pose(pose));
        // A device in VIEW goes with the head; in any other space it stays where the space is now.
        const Pose base = space->is_view() ? space->root_from_space() : space->world_from_space(session->host().clock().now()).pose;
        session->input().overrides().set_location(path, {space->is_view(), base * to_pose(pose)});
        return XR_SUCCESS;
    });
}

}  // namespace entoptic::runtime::api
