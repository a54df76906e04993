#include "runtime/objects/space.h"

#include "runtime/objects/instance.h"
#include "runtime/objects/session.h"

#include <algorithm>
#include <cmath>

namespace entoptic::runtime {

namespace {

constexpr DurationNs furthest_prediction = ns_per_s;
constexpr DurationNs furthest_history = 3600 * ns_per_s;

// Sources keep a second of history and predict less: a request from beyond is answered with what they have.
TimeNs within_reach(TimeNs time, TimeNs now) {
    return std::clamp(time, now > furthest_history ? now - furthest_history : TimeNs{1}, now + furthest_prediction);
}

PoseState fixed(const Pose& pose) {
    PoseState state;
    state.pose = pose;
    state.orientation_valid = state.position_valid = true;
    state.orientation_tracked = state.position_tracked = true;
    state.velocity_valid = true;
    return state;
}

// Rotation that turns -z to `direction`, with no roll about it.
glm::quat looking_along(glm::vec3 direction) {
    const float length = glm::length(direction);
    if (!(length > 1e-6f)) return {1, 0, 0, 0};
    direction /= length;
    const float yaw = std::atan2(-direction.x, -direction.z);
    const float pitch = std::asin(std::clamp(direction.y, -1.0f, 1.0f));
    return glm::angleAxis(yaw, glm::vec3(0, 1, 0)) * glm::angleAxis(pitch, glm::vec3(1, 0, 0));
}

// The palm (grip_surface, palm_ext) in the grip. choice: a handle of 3 cm, whose axis the outstretched fingers meet at 60 degrees; no device
// here measures it. Axes as the specification's "Standard pose identifiers" has them.
Pose grip_from_palm(UserPath user) {
    const float side = user == UserPath::left_hand ? -0.015f : 0.015f;
    return {glm::angleAxis(glm::radians(-60.0f), glm::vec3(1, 0, 0)), glm::vec3(side, 0, 0)};
}

}  // namespace

Space::Space(std::shared_ptr<Session> session, XrReferenceSpaceType reference, Pose root_from_space)
    : Object(ObjectType::space), session_(std::move(session)), reference_(reference), root_from_space_(root_from_space) {}

Space::Space(std::shared_ptr<Session> session, std::shared_ptr<Action> action, std::optional<UserPath> subaction, Pose root_from_space)
    : Object(ObjectType::space),
      session_(std::move(session)),
      action_(std::move(action)),
      subaction_(subaction),
      root_from_space_(root_from_space) {}

Instance& Space::instance() { return session_->instance(); }

std::optional<PoseRoot> Space::pose_root() const {
    return action_ && session_->focused() ? session_->input().pose_root(*action_, subaction_) : std::nullopt;
}

bool Space::same_root(const Space& other) const {
    if (!action_ || !other.action_) return !action_ && !other.action_ && reference_ == other.reference_;
    const auto root = pose_root();
    return root && root == other.pose_root();
}

PoseState Space::world_from_device(TimeNs time, TimeNs* gaze_sample_time) const {
    const std::optional<PoseRoot> root = pose_root();
    if (!root) return {};
    if (const auto device = session_->input().overrides().device(root->user)) {
        return device->active ? world_from_override(*root, time) : PoseState{};
    }
    Headset& headset = session_->host().headset();
    if (root->source == Source::gaze) {
        const Observer observer = headset.eye_tracker->observer_at(time);
        const EyeState& left = observer.eyes[0];
        const EyeState& right = observer.eyes[1];
        const auto best = std::max(left.gaze_provenance, right.gaze_provenance);
        if (gaze_sample_time) *gaze_sample_time = std::max(left.sample_time, right.sample_time);
        if (best == Provenance::absent) return {};
        PoseState state = attached(headset.head->pose_at(time), {looking_along(observer.gaze_direction), glm::vec3(0)});
        state.velocity_valid = false;  // the eye's own rotation is not measured
        // XR_EXT_eye_gaze_interaction: both tracked bits go together, and are set when the quality is nominal.
        state.orientation_tracked = state.position_tracked = state.position_tracked && best == Provenance::measured;
        return state;
    }
    ControllerSource* controller = headset.controllers[root->user == UserPath::right_hand ? 1 : 0];
    if (!controller) return {};
    const ControllerState state = controller->state_at(time);
    if (!state.active) return {};
    if (root->source == Source::palm) return attached(state.grip, grip_from_palm(root->user));
    return root->source == Source::grip ? state.grip : state.aim;
}

// A pose of a device that the application plays: where it put it; else the palm by the grip; else in front of LOCAL's origin.
PoseState Space::world_from_override(const PoseRoot& root, TimeNs time) const {
    const auto location = session_->input().overrides().location(std::string(user_path_text(root.user)) + std::string(root.component));
    if (location) {
        return location->head_locked ? attached(session_->host().headset().head->pose_at(time), location->pose) : fixed(location->pose);
    }
    if (root.source == Source::palm) {
        return attached(world_from_override({root.user, Source::grip, "/input/grip/pose"}, time), grip_from_palm(root.user));
    }
    const float side = root.user == UserPath::left_hand ? -0.2f : 0.2f;
    return fixed(session_->world_from_local() * Pose{glm::quat(1, 0, 0, 0), glm::vec3(side, -0.2f, -0.4f)});
}

PoseState Space::world_from_root(TimeNs time, TimeNs* gaze_sample_time) const {
    if (action_) return world_from_device(time, gaze_sample_time);
    switch (static_cast<int>(reference_)) {
        case XR_REFERENCE_SPACE_TYPE_VIEW:
            return session_->host().headset().head->pose_at(time);
        case XR_REFERENCE_SPACE_TYPE_STAGE:
            return fixed({});
        case XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR: {
            Pose floor = session_->world_from_local();
            floor.position.y = 0;  // the world's origin is on the floor
            return fixed(floor);
        }
        default:
            return fixed(session_->world_from_local());
    }
}

PoseState Space::world_from_space(TimeNs time, TimeNs* gaze_sample_time) const {
    return attached(world_from_root(within_reach(time, session_->host().clock().now()), gaze_sample_time), root_from_space_);
}

PoseState attached(const PoseState& body, const Pose& body_from_point) {
    PoseState point = body;
    point.pose = body.pose * body_from_point;
    point.linear_velocity = body.linear_velocity + glm::cross(body.angular_velocity, body.pose.rotate(body_from_point.position));
    return point;
}

PoseState relative(const PoseState& base, const PoseState& other) {
    PoseState result;
    const Pose base_from_world = base.pose.inverse();
    result.pose = base_from_world * other.pose;
    const glm::vec3 arm = other.pose.position - base.pose.position;
    result.linear_velocity = base_from_world.rotate(other.linear_velocity - base.linear_velocity - glm::cross(base.angular_velocity, arm));
    result.angular_velocity = base_from_world.rotate(other.angular_velocity - base.angular_velocity);
    // A position in a base of unknown orientation means nothing.
    result.orientation_valid = base.orientation_valid && other.orientation_valid;
    result.position_valid = base.orientation_valid && base.position_valid && other.position_valid;
    result.orientation_tracked = result.orientation_valid && base.orientation_tracked && other.orientation_tracked;
    result.position_tracked = result.position_valid && base.position_tracked && other.position_tracked;
    result.velocity_valid = result.orientation_valid && base.velocity_valid && other.velocity_valid;
    return result;
}

PoseState locate(const Space& space, const Space& base, TimeNs time, TimeNs* gaze_sample_time) {
    if (space.same_root(base)) return fixed(base.root_from_space().inverse() * space.root_from_space());
    return relative(base.world_from_space(time), space.world_from_space(time, gaze_sample_time));
}

}  // namespace entoptic::runtime
