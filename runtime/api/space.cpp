// Spaces and views.
#include "runtime/objects/space.h"

#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/verify.h"
#include "runtime/objects/session.h"
#include "runtime/objects/views.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace entoptic::runtime::api {

namespace {

constexpr std::array reference_spaces{XR_REFERENCE_SPACE_TYPE_VIEW, XR_REFERENCE_SPACE_TYPE_LOCAL, XR_REFERENCE_SPACE_TYPE_STAGE,
                                      XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR};

// LOCAL_FLOOR, the last, came with 1.1.
std::span<const XrReferenceSpaceType> offered_spaces(Instance& instance) {
    const bool floor = instance.has(feature_1_1 | feature_local_floor);
    return std::span(reference_spaces).first(reference_spaces.size() - (floor ? 0u : 1u));
}

bool offered(Instance& instance, XrReferenceSpaceType type) {
    const auto spaces = offered_spaces(instance);
    return std::find(spaces.begin(), spaces.end(), type) != spaces.end();
}

Outcome space_unsupported(XrReferenceSpaceType type) {
    return error(XR_ERROR_REFERENCE_SPACE_UNSUPPORTED, "reference space {} is not offered; take one from xrEnumerateReferenceSpaces",
                 static_cast<int>(type));
}

// XrSpaceVelocity or XrSpaceVelocityData.
template <class Velocity> void write_velocity(const PoseState& state, Velocity& velocity) {
    velocity.velocityFlags = 0;
    velocity.linearVelocity = velocity.angularVelocity = {0, 0, 0};
    if (!state.velocity_valid) return;
    velocity.angularVelocity = to_xr(state.angular_velocity);
    velocity.velocityFlags |= XR_SPACE_VELOCITY_ANGULAR_VALID_BIT;
    if (!state.position_valid) return;
    velocity.linearVelocity = to_xr(state.linear_velocity);
    velocity.velocityFlags |= XR_SPACE_VELOCITY_LINEAR_VALID_BIT;
}

// A pose whose parts are not valid must not look like one.
Pose valid_parts(const PoseState& state) {
    Pose pose = state.pose;
    if (!state.orientation_valid) pose.orientation = {1, 0, 0, 0};
    if (!state.position_valid) pose.position = glm::vec3(0);
    return pose;
}

Outcome read_spaces(const Session& session, const XrSpacesLocateInfo& info, std::vector<std::shared_ptr<Space>>& spaces) {
    if (info.spaceCount == 0) return invalid("spaceCount is 0");
    ENTOPTIC_XR_TRY(require_pointer(info.spaces, "locateInfo->spaces"));
    for (std::uint32_t i = 0; i < info.spaceCount; ++i) {
        std::shared_ptr<Space> space;
        ENTOPTIC_XR_TRY(find(info.spaces[i], space));
        if (space->session().get() != &session) return invalid("spaces[{}] belongs to another session", i);
        spaces.push_back(std::move(space));
    }
    return XR_SUCCESS;
}

Outcome check_count(std::uint32_t count, const void* array, std::size_t wanted, const char* what) {
    if (count != wanted) return invalid("there is room for {} {}; it must be exactly for the {} spaces", count, what, wanted);
    return require_pointer(array, what);
}

Outcome check_action_space(const Session& session, const XrActionSpaceCreateInfo& info, std::shared_ptr<Action>& action,
                           std::optional<UserPath>& subaction) {
    ENTOPTIC_XR_TRY(find(info.action, action));
    if (&action->instance() != &const_cast<Session&>(session).instance()) return invalid("the action belongs to another instance");
    if (action->type != XR_ACTION_TYPE_POSE_INPUT) {
        return error(XR_ERROR_ACTION_TYPE_MISMATCH, "action \"{}\" is not a pose action", action->name);
    }
    if (info.subactionPath == XR_NULL_PATH) return XR_SUCCESS;
    std::string text;
    ENTOPTIC_XR_TRY(action->instance().paths().to_string(info.subactionPath, text));
    subaction = parse_user_path(text);
    if (subaction && action->declares(*subaction)) return XR_SUCCESS;
    return error(XR_ERROR_PATH_UNSUPPORTED, "action \"{}\" was not created with the subaction path {}", action->name, text);
}

}  // namespace

XrResult XRAPI_CALL enumerate_reference_spaces(XrSession handle, uint32_t capacity, uint32_t* count, XrReferenceSpaceType* spaces) {
    return call("xrEnumerateReferenceSpaces", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        return two_call_values(capacity, count, spaces, offered_spaces(session->instance()));
    });
}

XrResult XRAPI_CALL create_reference_space(XrSession handle, const XrReferenceSpaceCreateInfo* info, XrSpace* space) {
    return call("xrCreateReferenceSpace", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_REFERENCE_SPACE_CREATE_INFO, "createInfo"));
        ENTOPTIC_XR_TRY(require_pointer(space, "space"));
        if (!offered(session->instance(), info->referenceSpaceType)) return space_unsupported(info->referenceSpaceType);
        ENTOPTIC_XR_TRY(check_pose(info->poseInReferenceSpace));
        return publish(std::make_shared<Space>(session, info->referenceSpaceType, to_pose(info->poseInReferenceSpace)),
                       handle_value(handle), space);
    });
}

XrResult XRAPI_CALL get_reference_space_bounds_rect(XrSession handle, XrReferenceSpaceType type, XrExtent2Df* bounds) {
    return call("xrGetReferenceSpaceBoundsRect", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require_pointer(bounds, "bounds"));
        if (type == XR_REFERENCE_SPACE_TYPE_MAX_ENUM) return invalid("XR_REFERENCE_SPACE_TYPE_MAX_ENUM is not a reference space");
        if (!offered(session->instance(), type)) return space_unsupported(type);
        const glm::vec2 area = session->host().headset().play_area_m;
        const bool known = type == XR_REFERENCE_SPACE_TYPE_STAGE && area.x > 0 && area.y > 0;
        *bounds = known ? XrExtent2Df{area.x, area.y} : XrExtent2Df{0, 0};
        return known ? XR_SUCCESS : XR_SPACE_BOUNDS_UNAVAILABLE;
    });
}

XrResult XRAPI_CALL create_action_space(XrSession handle, const XrActionSpaceCreateInfo* info, XrSpace* space) {
    return call("xrCreateActionSpace", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_ACTION_SPACE_CREATE_INFO, "createInfo"));
        ENTOPTIC_XR_TRY(require_pointer(space, "space"));
        std::shared_ptr<Action> action;
        std::optional<UserPath> subaction;
        ENTOPTIC_XR_TRY(check_action_space(*session, *info, action, subaction));
        ENTOPTIC_XR_TRY(check_pose(info->poseInActionSpace));
        return publish(std::make_shared<Space>(session, action, subaction, to_pose(info->poseInActionSpace)), handle_value(handle), space);
    });
}

XrResult XRAPI_CALL destroy_space(XrSpace handle) {
    return call("xrDestroySpace", handle, [&] { return destroy<Space>(handle_value(handle)); });
}

XrResult XRAPI_CALL locate_space(XrSpace handle, XrSpace base_handle, XrTime time, XrSpaceLocation* location) {
    return call("xrLocateSpace", handle, [&]() -> Outcome {
        std::shared_ptr<Space> space, base;
        ENTOPTIC_XR_TRY(find(handle, space));
        ENTOPTIC_XR_TRY(find(base_handle, base));
        ENTOPTIC_XR_TRY(require(location, XR_TYPE_SPACE_LOCATION, "location"));
        if (space->session() != base->session()) return invalid("the two spaces belong to different sessions");
        ENTOPTIC_XR_TRY(check_time(time));
        TimeNs gaze_time = 0;
        const PoseState state = locate(*space, *base, time, &gaze_time);
        location->locationFlags = location_flags(state);
        location->pose = to_xr(valid_parts(state));
        if (auto* velocity = chained<XrSpaceVelocity>(location->next, XR_TYPE_SPACE_VELOCITY)) write_velocity(state, *velocity);
        auto* sample = chained<XrEyeGazeSampleTimeEXT>(location->next, XR_TYPE_EYE_GAZE_SAMPLE_TIME_EXT);
        if (sample && space->instance().enabled(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME)) sample->time = gaze_time;
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL locate_spaces(XrSession handle, const XrSpacesLocateInfo* info, XrSpaceLocations* locations) {
    return call("xrLocateSpaces", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        std::vector<std::shared_ptr<Space>> spaces;
        std::shared_ptr<Space> base;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_SPACES_LOCATE_INFO, "locateInfo"));
        ENTOPTIC_XR_TRY(require(locations, XR_TYPE_SPACE_LOCATIONS, "spaceLocations"));
        ENTOPTIC_XR_TRY(find(info->baseSpace, base));
        if (base->session() != session) return invalid("the base space belongs to another session");
        ENTOPTIC_XR_TRY(read_spaces(*session, *info, spaces));
        ENTOPTIC_XR_TRY(check_time(info->time));
        auto* velocities = chained<XrSpaceVelocities>(locations->next, XR_TYPE_SPACE_VELOCITIES);
        ENTOPTIC_XR_TRY(check_count(locations->locationCount, locations->locations, spaces.size(), "locations"));
        if (velocities) ENTOPTIC_XR_TRY(check_count(velocities->velocityCount, velocities->velocities, spaces.size(), "velocities"));
        for (std::size_t i = 0; i < spaces.size(); ++i) {
            const PoseState state = locate(*spaces[i], *base, info->time);
            locations->locations[i] = {location_flags(state), to_xr(valid_parts(state))};
            if (velocities) write_velocity(state, velocities->velocities[i]);
        }
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL locate_views(XrSession handle, const XrViewLocateInfo* info, XrViewState* view_state, uint32_t capacity,
                                 uint32_t* count, XrView* views) {
    return call("xrLocateViews", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_VIEW_LOCATE_INFO, "viewLocateInfo"));
        ENTOPTIC_XR_TRY(require(view_state, XR_TYPE_VIEW_STATE, "viewState"));
        std::shared_ptr<Space> base;
        ENTOPTIC_XR_TRY(find(info->space, base));
        if (base->session() != session) return invalid("viewLocateInfo->space belongs to another session");
        ENTOPTIC_XR_TRY(check_view_configuration(session->instance(), info->viewConfigurationType));
        ENTOPTIC_XR_TRY(check_time(info->displayTime));
        const std::size_t view_total = view_count(info->viewConfigurationType);
        bool fill = false;
        ENTOPTIC_XR_TRY(two_call(capacity, count, views, view_total, fill));
        for (std::size_t i = 0; fill && i < view_total; ++i)
            ENTOPTIC_XR_TRY(require_element(session->instance(), views[i], XR_TYPE_VIEW, "views"));
        const Space view(session, XR_REFERENCE_SPACE_TYPE_VIEW, {});
        const PoseState head = locate(view, *base, info->displayTime);
        view_state->viewStateFlags = location_flags(head);  // the bits are the same
        if (!fill) return XR_SUCCESS;
        Headset& headset = session->host().headset();
        const auto fovs = view_fovs(headset, info->viewConfigurationType, info->displayTime);
        for (std::size_t i = 0; i < view_total; ++i) {
            views[i].pose = to_xr(valid_parts(attached(head, headset.eyes[i % eye_count].head_from_eye)));
            views[i].fov = {fovs[i].angle_left, fovs[i].angle_right, fovs[i].angle_up, fovs[i].angle_down};
        }
        return XR_SUCCESS;
    });
}

}  // namespace entoptic::runtime::api
