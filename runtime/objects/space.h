// XrSpace, and where things are: every space is a fixed pose in a root, and every root is located in the world.
// World coordinates are STAGE's: origin on the floor, y up (interfaces/sources.h). LOCAL's origin is the head's when the session was made.
#pragma once

#include "base/pose.h"
#include "interfaces/sources.h"
#include "runtime/objects/action.h"
#include "runtime/objects/action_input.h"
#include "runtime/objects/handle_table.h"

#include <memory>
#include <optional>

namespace entoptic::runtime {

class Session;

class Space final : public Object {
public:
    Space(std::shared_ptr<Session> session, XrReferenceSpaceType reference, Pose root_from_space);
    Space(std::shared_ptr<Session> session, std::shared_ptr<Action> action, std::optional<UserPath> subaction, Pose root_from_space);
    Instance& instance() override;

    const std::shared_ptr<Session>& session() const { return session_; }
    const Pose& root_from_space() const { return root_from_space_; }
    // True for VIEW: the space moves with the head.
    bool is_view() const { return !action_ && reference_ == XR_REFERENCE_SPACE_TYPE_VIEW; }
    // Follows the same thing as the other space, so that their relation never changes.
    bool same_root(const Space& other) const;

    // The space in the world at `time`. Flags of an action space are all false while its action is inactive.
    // `gaze_sample_time`: when the eyes were seen, for spaces that follow the gaze; else 0.
    PoseState world_from_space(TimeNs time, TimeNs* gaze_sample_time = nullptr) const;

private:
    PoseState world_from_root(TimeNs time, TimeNs* gaze_sample_time) const;
    PoseState world_from_device(TimeNs time, TimeNs* gaze_sample_time) const;
    PoseState world_from_override(const PoseRoot& root, TimeNs time) const;
    std::optional<PoseRoot> pose_root() const;

    const std::shared_ptr<Session> session_;
    const XrReferenceSpaceType reference_ = XR_REFERENCE_SPACE_TYPE_MAX_ENUM;
    const std::shared_ptr<Action> action_;
    const std::optional<UserPath> subaction_;
    const Pose root_from_space_;
};

// `space` in `base` at `time`, with velocity in base's coordinates.
PoseState locate(const Space& space, const Space& base, TimeNs time, TimeNs* gaze_sample_time = nullptr);
// The same for a base and something already located in the world.
PoseState relative(const PoseState& base, const PoseState& world_from_other);
// A point fixed in a moving body.
PoseState attached(const PoseState& body, const Pose& body_from_point);

}  // namespace entoptic::runtime
