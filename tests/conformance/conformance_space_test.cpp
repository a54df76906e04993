// labels: gpu
// Spaces and views: relations of every pair, history and prediction, velocities, validity, eye gaze.
#include "runtime/testing/client.h"

#include <cmath>

namespace entoptic::runtime::testing {
namespace {

constexpr XrSpaceLocationFlags valid = XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT;
constexpr XrSpaceLocationFlags tracked = XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT | XR_SPACE_LOCATION_POSITION_TRACKED_BIT;
constexpr XrPosef identity{{0, 0, 0, 1}, {0, 0, 0}};

class Spaces : public SessionTest {
public:
    void SetUp() override {
        SessionTest::SetUp();
        local = reference_space(XR_REFERENCE_SPACE_TYPE_LOCAL);
        view = reference_space(XR_REFERENCE_SPACE_TYPE_VIEW);
        stage = reference_space(XR_REFERENCE_SPACE_TYPE_STAGE);
    }
    // The head walks along x at 1 m/s and turns about y at 1 rad/s.
    void walk() {
        xr.host->head.script = [](TimeNs time) {
            PoseState state = FakePoseSource::still();
            const float s = static_cast<float>(seconds(time - ns_per_s));
            state.pose.position = {s, 0, 0};
            state.pose.orientation = glm::angleAxis(s, glm::vec3(0, 1, 0));
            state.linear_velocity = {1, 0, 0};
            state.angular_velocity = {0, 1, 0};
            return state;
        };
    }
    XrSpace local = XR_NULL_HANDLE, view = XR_NULL_HANDLE, stage = XR_NULL_HANDLE;
};

TEST_F(Spaces, ReferenceSpaces) {
    const XrSpaceLocation in_stage = locate(local, stage, now());
    EXPECT_EQ(in_stage.locationFlags, valid | tracked);
    EXPECT_FLOAT_EQ(in_stage.pose.position.y, 1.2f) << "LOCAL is at the eyes, STAGE on the floor";
    std::uint32_t count = 0;
    ASSERT_EQ(xr.xrEnumerateReferenceSpaces(session, 0, &count, nullptr), XR_SUCCESS);
    EXPECT_EQ(count, 3u);
    XrExtent2Df bounds{9, 9};
    EXPECT_EQ(xr.xrGetReferenceSpaceBoundsRect(session, XR_REFERENCE_SPACE_TYPE_STAGE, &bounds), XR_SPACE_BOUNDS_UNAVAILABLE);
    EXPECT_FLOAT_EQ(bounds.width, 0);
    EXPECT_EQ(xr.xrGetReferenceSpaceBoundsRect(session, XR_REFERENCE_SPACE_TYPE_UNBOUNDED_MSFT, &bounds),
              XR_ERROR_REFERENCE_SPACE_UNSUPPORTED);
    EXPECT_EQ(xr.xrGetReferenceSpaceBoundsRect(session, XR_REFERENCE_SPACE_TYPE_MAX_ENUM, &bounds), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrGetReferenceSpaceBoundsRect(session, XR_REFERENCE_SPACE_TYPE_LOCAL, nullptr), XR_ERROR_VALIDATION_FAILURE);
}

TEST_F(Spaces, CreationErrors) {
    XrReferenceSpaceCreateInfo info{XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr, XR_REFERENCE_SPACE_TYPE_LOCAL, identity};
    XrSpace space = XR_NULL_HANDLE;
    info.poseInReferenceSpace.orientation.w = 0;
    EXPECT_EQ(xr.xrCreateReferenceSpace(session, &info, &space), XR_ERROR_POSE_INVALID);
    info.poseInReferenceSpace = identity;
    info.poseInReferenceSpace.position.x = NAN;
    EXPECT_EQ(xr.xrCreateReferenceSpace(session, &info, &space), XR_ERROR_POSE_INVALID);
    info.poseInReferenceSpace = identity;
    info.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_UNBOUNDED_MSFT;
    EXPECT_EQ(xr.xrCreateReferenceSpace(session, &info, &space), XR_ERROR_REFERENCE_SPACE_UNSUPPORTED);
    info.type = XR_TYPE_UNKNOWN;
    EXPECT_EQ(xr.xrCreateReferenceSpace(session, &info, &space), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrCreateReferenceSpace(XR_NULL_HANDLE, &info, &space), XR_ERROR_HANDLE_INVALID);
}

TEST_F(Spaces, OffsetsCompose) {
    const float half = std::sqrt(0.5f);
    const XrSpace turned = reference_space(XR_REFERENCE_SPACE_TYPE_LOCAL, {{0, half, 0, half}, {1, 2, 3}});  // 90° to the left
    const XrSpace ahead = reference_space(XR_REFERENCE_SPACE_TYPE_LOCAL, {{0, 0, 0, 1}, {1, 2, 2}});
    const XrSpaceLocation found = locate(ahead, turned, now());
    EXPECT_NEAR(found.pose.position.x, 1, 1e-5) << "-z of LOCAL is +x of the turned space";
    EXPECT_NEAR(found.pose.position.y, 0, 1e-5);
    EXPECT_NEAR(found.pose.position.z, 0, 1e-5);
    const XrSpaceLocation back = locate(turned, ahead, now());
    EXPECT_NEAR(back.pose.position.z, 1, 1e-5);
}

TEST_F(Spaces, HeadMovesThroughHistoryAndPrediction) {
    walk();
    XrSpaceVelocity velocity{XR_TYPE_SPACE_VELOCITY};
    XrSpaceLocation found = locate(view, local, now() + ns_per_s / 2, &velocity);
    EXPECT_EQ(found.locationFlags, valid | tracked);
    EXPECT_NEAR(found.pose.position.x, 0.5, 1e-4);
    EXPECT_EQ(velocity.velocityFlags, XrSpaceVelocityFlags(XR_SPACE_VELOCITY_LINEAR_VALID_BIT | XR_SPACE_VELOCITY_ANGULAR_VALID_BIT));
    EXPECT_NEAR(velocity.linearVelocity.x, 1, 1e-5);
    EXPECT_NEAR(velocity.angularVelocity.y, 1, 1e-5);
    found = locate(view, local, now() - ns_per_s / 2);
    EXPECT_NEAR(found.pose.position.x, -0.5, 1e-4);
    found = locate(local, view, now(), &velocity);
    EXPECT_NEAR(velocity.linearVelocity.x, -1, 1e-5) << "seen from the head the world goes the other way";
    EXPECT_NEAR(velocity.angularVelocity.y, -1, 1e-5);
    const XrSpace nose = reference_space(XR_REFERENCE_SPACE_TYPE_VIEW, {{0, 0, 0, 1}, {0, 0, -1}});
    found = locate(nose, local, now(), &velocity);
    EXPECT_NEAR(velocity.linearVelocity.x, 0, 1e-5) << "1 m/s of walking less 1 m/s of turning at arm's length";
    found = locate(nose, view, now(), &velocity);
    EXPECT_NEAR(velocity.linearVelocity.x, 0, 0) << "fixed to each other";
    EXPECT_FLOAT_EQ(found.pose.position.z, -1);
}

TEST_F(Spaces, TimesOutOfReach) {
    walk();
    XrSpaceLocation location{XR_TYPE_SPACE_LOCATION};
    EXPECT_EQ(xr.xrLocateSpace(view, local, 0, &location), XR_ERROR_TIME_INVALID);
    EXPECT_EQ(xr.xrLocateSpace(view, local, -1, &location), XR_ERROR_TIME_INVALID);
    EXPECT_EQ(xr.xrLocateSpace(view, local, INT64_MAX, &location), XR_SUCCESS);
    EXPECT_LT(location.pose.position.x, 10) << "prediction is bounded";
    EXPECT_EQ(xr.xrLocateSpace(view, local, 1, &location), XR_SUCCESS);
    location.type = XR_TYPE_UNKNOWN;
    EXPECT_EQ(xr.xrLocateSpace(view, local, now(), &location), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrLocateSpace(view, local, now(), nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrLocateSpace(view, XR_NULL_HANDLE, now(), &location), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(xr.xrDestroySpace(view), XR_SUCCESS);
    EXPECT_EQ(xr.xrLocateSpace(view, local, now(), &location), XR_ERROR_HANDLE_INVALID);
}

TEST_F(Spaces, LostHeadIsNotValid) {
    xr.host->head.script = [](TimeNs) {
        PoseState state = FakePoseSource::still();
        state.position_valid = state.position_tracked = state.orientation_tracked = false;
        state.pose.position = {5, 5, 5};
        return state;
    };
    const XrSpaceLocation found = locate(view, local, now());
    EXPECT_EQ(found.locationFlags, XrSpaceLocationFlags(XR_SPACE_LOCATION_ORIENTATION_VALID_BIT));
    EXPECT_FLOAT_EQ(found.pose.position.x, 0);
    const XrSpaceLocation self = locate(view, view, now());
    EXPECT_EQ(self.locationFlags, valid | tracked) << "a space in itself is always known";
}

TEST_F(Spaces, Views) {
    walk();
    XrViewLocateInfo info{XR_TYPE_VIEW_LOCATE_INFO, nullptr, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, now(), view};
    XrViewState state{XR_TYPE_VIEW_STATE};
    std::vector<XrView> views(2, {XR_TYPE_VIEW});
    std::uint32_t count = 0;
    EXPECT_EQ(xr.xrLocateViews(session, &info, &state, 0, &count, nullptr), XR_SUCCESS);
    EXPECT_EQ(count, 2u);
    EXPECT_EQ(xr.xrLocateViews(session, &info, &state, 1, &count, views.data()), XR_ERROR_SIZE_INSUFFICIENT);
    ASSERT_EQ(xr.xrLocateViews(session, &info, &state, 2, &count, views.data()), XR_SUCCESS);
    EXPECT_EQ(state.viewStateFlags, XrViewStateFlags(0xf));
    EXPECT_FLOAT_EQ(views[0].pose.position.x, -0.0315f);
    EXPECT_FLOAT_EQ(views[1].pose.position.x, 0.0315f);
    EXPECT_FLOAT_EQ(views[1].fov.angleRight, 0.9f);
    info.space = local;
    info.displayTime = now() + ns_per_s;
    ASSERT_EQ(xr.xrLocateViews(session, &info, &state, 2, &count, views.data()), XR_SUCCESS);
    EXPECT_NEAR(views[0].pose.position.x, 1 - 0.0315 * std::cos(1.0), 1e-4);
    info.displayTime = 0;
    EXPECT_EQ(xr.xrLocateViews(session, &info, &state, 2, &count, views.data()), XR_ERROR_TIME_INVALID);
    info.displayTime = now();
    info.viewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_MONO;
    EXPECT_EQ(xr.xrLocateViews(session, &info, &state, 2, &count, views.data()), XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED);
    info.viewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
    views[1].type = XR_TYPE_UNKNOWN;
    EXPECT_EQ(xr.xrLocateViews(session, &info, &state, 2, &count, views.data()), XR_ERROR_VALIDATION_FAILURE);
    info.space = XR_NULL_HANDLE;
    EXPECT_EQ(xr.xrLocateViews(session, &info, &state, 2, &count, views.data()), XR_ERROR_HANDLE_INVALID);
}

TEST_F(Spaces, EyeGaze) {
    XrActionSetCreateInfo set_info{XR_TYPE_ACTION_SET_CREATE_INFO, nullptr, "gaze", "Gaze", 0};
    XrActionSet set = XR_NULL_HANDLE;
    ASSERT_EQ(xr.xrCreateActionSet(xr.instance, &set_info, &set), XR_SUCCESS);
    XrActionCreateInfo action_info{XR_TYPE_ACTION_CREATE_INFO, nullptr, "gaze", XR_ACTION_TYPE_POSE_INPUT, 0, nullptr, "Gaze"};
    XrAction action = XR_NULL_HANDLE;
    ASSERT_EQ(xr.xrCreateAction(set, &action_info, &action), XR_SUCCESS);
    const XrActionSuggestedBinding binding{action, xr.path("/user/eyes_ext/input/gaze_ext/pose")};
    const XrInteractionProfileSuggestedBinding suggested{XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, nullptr,
                                                         xr.path("/interaction_profiles/ext/eye_gaze_interaction"), 1, &binding};
    ASSERT_EQ(xr.xrSuggestInteractionProfileBindings(xr.instance, &suggested), XR_SUCCESS);
    const XrSessionActionSetsAttachInfo attach{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, 1, &set};
    ASSERT_EQ(xr.xrAttachSessionActionSets(session, &attach), XR_SUCCESS);
    const XrActionSpaceCreateInfo space_info{XR_TYPE_ACTION_SPACE_CREATE_INFO, nullptr, action, XR_NULL_PATH, identity};
    XrSpace gaze = XR_NULL_HANDLE;
    ASSERT_EQ(xr.xrCreateActionSpace(session, &space_info, &gaze), XR_SUCCESS);
    EXPECT_EQ(locate(gaze, view, now()).locationFlags, 0u) << "not synchronised yet";
    run_to_focus();
    const XrActiveActionSet active{set, XR_NULL_PATH};
    const XrActionsSyncInfo sync{XR_TYPE_ACTIONS_SYNC_INFO, nullptr, 1, &active};
    ASSERT_EQ(xr.xrSyncActions(session, &sync), XR_SUCCESS);

    Observer& eyes = xr.host->eyes.state;
    eyes.gaze_direction = glm::normalize(glm::vec3(1, 0, -1));  // 45° to the right
    eyes.eyes[0].gaze_provenance = eyes.eyes[1].gaze_provenance = Provenance::measured;
    eyes.eyes[0].sample_time = 900;
    eyes.eyes[1].sample_time = 1000;
    XrEyeGazeSampleTimeEXT sample{XR_TYPE_EYE_GAZE_SAMPLE_TIME_EXT};
    XrSpaceLocation found = locate(gaze, view, now(), &sample);
    EXPECT_EQ(found.locationFlags, valid | tracked);
    EXPECT_EQ(sample.time, 1000);
    const glm::quat turn(found.pose.orientation.w, found.pose.orientation.x, found.pose.orientation.y, found.pose.orientation.z);
    const glm::vec3 forward = turn * glm::vec3(0, 0, -1);
    EXPECT_NEAR(forward.x, std::sqrt(0.5), 1e-5);
    EXPECT_NEAR(forward.z, -std::sqrt(0.5), 1e-5);

    eyes.eyes[0].gaze_provenance = eyes.eyes[1].gaze_provenance = Provenance::modelled;
    EXPECT_EQ(locate(gaze, view, now()).locationFlags, valid) << "degraded: both tracked bits are clear";
    eyes.eyes[0].gaze_provenance = eyes.eyes[1].gaze_provenance = Provenance::absent;
    EXPECT_EQ(locate(gaze, view, now()).locationFlags, 0u);
    XrActionStateGetInfo get{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action, XR_NULL_PATH};
    XrActionStatePose pose{XR_TYPE_ACTION_STATE_POSE};
    EXPECT_EQ(xr.xrGetActionStatePose(session, &get, &pose), XR_SUCCESS);
    EXPECT_EQ(pose.isActive, XR_TRUE);
    xr.host->eyes.is_present = false;
    ASSERT_EQ(xr.xrSyncActions(session, &sync), XR_SUCCESS);
    EXPECT_EQ(xr.xrGetActionStatePose(session, &get, &pose), XR_SUCCESS);
    EXPECT_EQ(pose.isActive, XR_FALSE);
}

}  // namespace
}  // namespace entoptic::runtime::testing
