// labels: gpu
// Actions: names, bindings, attachment, states and their conversions, priorities, profiles, haptics.
#include "runtime/testing/client.h"

namespace entoptic::runtime::testing {
namespace {

constexpr const char* index_profile = "/interaction_profiles/valve/index_controller";
constexpr const char* simple_profile = "/interaction_profiles/khr/simple_controller";

class Actions : public SessionTest {
public:
    void SetUp() override {
        SessionTest::SetUp();
        left = xr.path("/user/hand/left");
        right = xr.path("/user/hand/right");
        set = make_set("set", 0);
    }
    XrActionSet make_set(const char* name, std::uint32_t priority, XrResult expected = XR_SUCCESS) {
        XrActionSetCreateInfo info{XR_TYPE_ACTION_SET_CREATE_INFO, nullptr, "", "", priority};
        std::strcpy(info.actionSetName, name);
        std::strcpy(info.localizedActionSetName, name);
        XrActionSet made = XR_NULL_HANDLE;
        EXPECT_EQ(xr.xrCreateActionSet(xr.instance, &info, &made), expected) << name;
        return made;
    }
    XrAction make_action(XrActionSet owner, const char* name, XrActionType type, std::vector<XrPath> subactions = {},
                         XrResult expected = XR_SUCCESS) {
        XrActionCreateInfo info{XR_TYPE_ACTION_CREATE_INFO, nullptr, "", type, static_cast<std::uint32_t>(subactions.size()),
                                subactions.data(),          ""};
        std::strcpy(info.actionName, name);
        std::strcpy(info.localizedActionName, name);
        XrAction made = XR_NULL_HANDLE;
        EXPECT_EQ(xr.xrCreateAction(owner, &info, &made), expected) << name;
        return made;
    }
    XrResult suggest(const char* profile, std::vector<std::pair<XrAction, const char*>> pairs) {
        std::vector<XrActionSuggestedBinding> bindings;
        for (const auto& [action, path] : pairs) bindings.push_back({action, xr.path(path)});
        const XrInteractionProfileSuggestedBinding info{XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, nullptr, xr.path(profile),
                                                        static_cast<std::uint32_t>(bindings.size()), bindings.data()};
        return xr.xrSuggestInteractionProfileBindings(xr.instance, &info);
    }
    XrResult attach(std::vector<XrActionSet> sets) {
        const XrSessionActionSetsAttachInfo info{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, static_cast<std::uint32_t>(sets.size()),
                                                 sets.data()};
        return xr.xrAttachSessionActionSets(session, &info);
    }
    XrResult sync(std::vector<XrActiveActionSet> active) {
        const XrActionsSyncInfo info{XR_TYPE_ACTIONS_SYNC_INFO, nullptr, static_cast<std::uint32_t>(active.size()), active.data()};
        return xr.xrSyncActions(session, &info);
    }
    XrActionStateBoolean boolean(XrAction action, XrPath subaction = XR_NULL_PATH) {
        const XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action, subaction};
        XrActionStateBoolean state{XR_TYPE_ACTION_STATE_BOOLEAN};
        EXPECT_EQ(xr.xrGetActionStateBoolean(session, &info, &state), XR_SUCCESS);
        return state;
    }
    XrActionStateFloat scalar(XrAction action, XrPath subaction = XR_NULL_PATH) {
        const XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action, subaction};
        XrActionStateFloat state{XR_TYPE_ACTION_STATE_FLOAT};
        EXPECT_EQ(xr.xrGetActionStateFloat(session, &info, &state), XR_SUCCESS);
        return state;
    }
    XrActionStateVector2f vector(XrAction action, XrPath subaction = XR_NULL_PATH) {
        const XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action, subaction};
        XrActionStateVector2f state{XR_TYPE_ACTION_STATE_VECTOR2F};
        EXPECT_EQ(xr.xrGetActionStateVector2f(session, &info, &state), XR_SUCCESS);
        return state;
    }
    std::string profile_of(XrPath user) {
        XrInteractionProfileState state{XR_TYPE_INTERACTION_PROFILE_STATE};
        EXPECT_EQ(xr.xrGetCurrentInteractionProfile(session, user, &state), XR_SUCCESS);
        return xr.text(state.interactionProfile);
    }
    int profile_events() {
        int count = 0;
        XrEventDataBuffer event{XR_TYPE_EVENT_DATA_BUFFER};
        while (xr.xrPollEvent(xr.instance, &event) == XR_SUCCESS) {
            count += event.type == XR_TYPE_EVENT_DATA_INTERACTION_PROFILE_CHANGED;
            event = {XR_TYPE_EVENT_DATA_BUFFER};
        }
        return count;
    }

    XrPath left = XR_NULL_PATH, right = XR_NULL_PATH;
    XrActionSet set = XR_NULL_HANDLE;
};

TEST_F(Actions, NamesOfSets) {
    make_set("", 0, XR_ERROR_NAME_INVALID);
    make_set("NOT VALID", 0, XR_ERROR_PATH_FORMAT_INVALID);
    make_set("set", 0, XR_ERROR_NAME_DUPLICATED);
    EXPECT_EQ(xr.xrDestroyActionSet(set), XR_SUCCESS);
    EXPECT_EQ(xr.xrDestroyActionSet(set), XR_ERROR_HANDLE_INVALID);
    set = make_set("set", 0);
    XrActionSetCreateInfo info{XR_TYPE_ACTION_SET_CREATE_INFO, nullptr, "other", "set", 0};
    XrActionSet made = XR_NULL_HANDLE;
    EXPECT_EQ(xr.xrCreateActionSet(xr.instance, &info, &made), XR_ERROR_LOCALIZED_NAME_DUPLICATED);
    info.localizedActionSetName[0] = 0;
    EXPECT_EQ(xr.xrCreateActionSet(xr.instance, &info, &made), XR_ERROR_LOCALIZED_NAME_INVALID);
    info.type = XR_TYPE_UNKNOWN;
    EXPECT_EQ(xr.xrCreateActionSet(xr.instance, &info, &made), XR_ERROR_VALIDATION_FAILURE);
}

TEST_F(Actions, Creation) {
    const XrAction action = make_action(set, "a", XR_ACTION_TYPE_BOOLEAN_INPUT, {left, right});
    make_action(set, "a", XR_ACTION_TYPE_BOOLEAN_INPUT, {}, XR_ERROR_NAME_DUPLICATED);
    make_action(set, "b", XR_ACTION_TYPE_BOOLEAN_INPUT, {left, left}, XR_ERROR_PATH_UNSUPPORTED);
    make_action(set, "b", XR_ACTION_TYPE_BOOLEAN_INPUT, {xr.path("/user/invalid")}, XR_ERROR_PATH_UNSUPPORTED);
    make_action(set, "b", XR_ACTION_TYPE_BOOLEAN_INPUT, {XrPath(0x12345)}, XR_ERROR_PATH_INVALID);
    make_action(set, "b", XrActionType(77), {}, XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrDestroyAction(action), XR_SUCCESS);
    make_action(set, "a", XR_ACTION_TYPE_BOOLEAN_INPUT);
    EXPECT_EQ(xr.xrDestroyAction(action), XR_ERROR_HANDLE_INVALID);
    const XrAction child = make_action(set, "c", XR_ACTION_TYPE_POSE_INPUT);
    EXPECT_EQ(xr.xrDestroyActionSet(set), XR_SUCCESS);
    EXPECT_EQ(xr.xrDestroyAction(child), XR_ERROR_HANDLE_INVALID);
}

TEST_F(Actions, Suggestions) {
    const XrAction action = make_action(set, "a", XR_ACTION_TYPE_BOOLEAN_INPUT);
    EXPECT_EQ(suggest(simple_profile, {{action, "/user/hand/left/input/select/click"}}), XR_SUCCESS);
    EXPECT_EQ(suggest(simple_profile, {{action, "/user/hand/left/input/select/click"}}), XR_SUCCESS);
    EXPECT_EQ(suggest(simple_profile, {}), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(suggest("/interaction_profiles/no/such", {{action, "/user/hand/left/input/select/click"}}), XR_ERROR_PATH_UNSUPPORTED);
    EXPECT_EQ(suggest(simple_profile, {{action, "/user/hand/left/input/trigger/value"}}), XR_ERROR_PATH_UNSUPPORTED);
    EXPECT_EQ(suggest(simple_profile, {{action, "/somewhere/else"}}), XR_ERROR_PATH_UNSUPPORTED);
    EXPECT_EQ(suggest(simple_profile, {{XR_NULL_HANDLE, "/user/hand/left/input/select/click"}}), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(suggest("/interaction_profiles/htc/vive_pro", {{action, "/user/head/input/volume_up/click"}}), XR_SUCCESS);
    ASSERT_EQ(attach({set}), XR_SUCCESS);
    EXPECT_EQ(suggest(simple_profile, {{action, "/user/hand/left/input/select/click"}}), XR_ERROR_ACTIONSETS_ALREADY_ATTACHED);
    make_action(set, "late", XR_ACTION_TYPE_BOOLEAN_INPUT, {}, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED);
    EXPECT_EQ(attach({set}), XR_ERROR_ACTIONSETS_ALREADY_ATTACHED);
}

TEST_F(Actions, EyeGazeProfileNeedsItsExtension) {
    Client plain(std::vector<const char*>{"XR_KHR_vulkan_enable2"});
    XrActionSetCreateInfo set_info{XR_TYPE_ACTION_SET_CREATE_INFO, nullptr, "set", "set", 0};
    XrActionSet made = XR_NULL_HANDLE;
    ASSERT_EQ(plain.xrCreateActionSet(plain.instance, &set_info, &made), XR_SUCCESS);
    XrActionCreateInfo info{XR_TYPE_ACTION_CREATE_INFO, nullptr, "gaze", XR_ACTION_TYPE_POSE_INPUT, 0, nullptr, "gaze"};
    XrAction action = XR_NULL_HANDLE;
    ASSERT_EQ(plain.xrCreateAction(made, &info, &action), XR_SUCCESS);
    const XrActionSuggestedBinding binding{action, plain.path("/user/eyes_ext/input/gaze_ext/pose")};
    const XrInteractionProfileSuggestedBinding suggested{XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, nullptr,
                                                         plain.path("/interaction_profiles/ext/eye_gaze_interaction"), 1, &binding};
    EXPECT_EQ(plain.xrSuggestInteractionProfileBindings(plain.instance, &suggested), XR_ERROR_PATH_UNSUPPORTED);
}

TEST_F(Actions, NothingWorksBeforeAttaching) {
    const XrAction action = make_action(set, "a", XR_ACTION_TYPE_BOOLEAN_INPUT);
    EXPECT_EQ(attach({}), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(attach({XR_NULL_HANDLE}), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(sync({{set, XR_NULL_PATH}}), XR_ERROR_ACTIONSET_NOT_ATTACHED);
    const XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action, XR_NULL_PATH};
    XrActionStateBoolean state{XR_TYPE_ACTION_STATE_BOOLEAN};
    EXPECT_EQ(xr.xrGetActionStateBoolean(session, &info, &state), XR_ERROR_ACTIONSET_NOT_ATTACHED);
    XrInteractionProfileState profile{XR_TYPE_INTERACTION_PROFILE_STATE};
    EXPECT_EQ(xr.xrGetCurrentInteractionProfile(session, left, &profile), XR_ERROR_ACTIONSET_NOT_ATTACHED);
    const XrBoundSourcesForActionEnumerateInfo sources{XR_TYPE_BOUND_SOURCES_FOR_ACTION_ENUMERATE_INFO, nullptr, action};
    std::uint32_t count = 0;
    EXPECT_EQ(xr.xrEnumerateBoundSourcesForAction(session, &sources, 0, &count, nullptr), XR_ERROR_ACTIONSET_NOT_ATTACHED);
    ASSERT_EQ(attach({set}), XR_SUCCESS);
    EXPECT_EQ(boolean(action).isActive, XR_FALSE);
    EXPECT_EQ(sync({{set, XR_NULL_PATH}}), XR_SESSION_NOT_FOCUSED);
    EXPECT_EQ(sync({}), XR_SESSION_NOT_FOCUSED);
    XrActionStateFloat wrong{XR_TYPE_ACTION_STATE_FLOAT};
    EXPECT_EQ(xr.xrGetActionStateFloat(session, &info, &wrong), XR_ERROR_ACTION_TYPE_MISMATCH);
    EXPECT_EQ(xr.xrGetCurrentInteractionProfile(session, XR_NULL_PATH, &profile), XR_ERROR_PATH_INVALID);
    EXPECT_EQ(xr.xrGetCurrentInteractionProfile(session, xr.path("/invalid/top"), &profile), XR_ERROR_PATH_UNSUPPORTED);
}

TEST_F(Actions, BooleanWithHysteresisAndChanges) {
    const XrAction action = make_action(set, "grab", XR_ACTION_TYPE_BOOLEAN_INPUT, {left, right});
    ASSERT_EQ(suggest(index_profile, {{action, "/user/hand/left/input/squeeze/value"}, {action, "/user/hand/right/input/squeeze"}}),
              XR_SUCCESS);
    ASSERT_EQ(attach({set}), XR_SUCCESS);
    run_to_focus();
    EXPECT_EQ(profile_of(left), "");
    static_cast<void>(profile_events());
    ASSERT_EQ(sync({{set, XR_NULL_PATH}}), XR_SUCCESS);
    EXPECT_EQ(profile_events(), 1);
    EXPECT_EQ(profile_of(left), index_profile);
    EXPECT_EQ(boolean(action).isActive, XR_TRUE);
    EXPECT_EQ(boolean(action).currentState, XR_FALSE);
    EXPECT_EQ(boolean(action).lastChangeTime, 0);
    const auto squeeze = [&](float value) {
        xr.host->right.change([&](ControllerState& state) { state.squeeze = value; });
        EXPECT_EQ(frame(), XR_SUCCESS);
        EXPECT_EQ(sync({{set, XR_NULL_PATH}}), XR_SUCCESS);
        return boolean(action, right);
    };
    EXPECT_EQ(squeeze(0.5f).currentState, XR_FALSE);
    const XrActionStateBoolean pressed = squeeze(0.8f);
    EXPECT_EQ(pressed.currentState, XR_TRUE);
    EXPECT_EQ(pressed.changedSinceLastSync, XR_TRUE);
    EXPECT_EQ(pressed.lastChangeTime, now());
    EXPECT_EQ(boolean(action).currentState, XR_TRUE) << "either hand";
    EXPECT_EQ(boolean(action, left).currentState, XR_FALSE);
    const XrActionStateBoolean held = squeeze(0.5f);
    EXPECT_EQ(held.currentState, XR_TRUE) << "hysteresis";
    EXPECT_EQ(held.changedSinceLastSync, XR_FALSE);
    EXPECT_EQ(held.lastChangeTime, pressed.lastChangeTime);
    EXPECT_EQ(squeeze(0.3f).currentState, XR_FALSE);
    EXPECT_EQ(profile_events(), 0);
}

TEST_F(Actions, FloatAndVector) {
    const XrAction trigger = make_action(set, "trigger", XR_ACTION_TYPE_FLOAT_INPUT, {left, right});
    const XrAction click = make_action(set, "click", XR_ACTION_TYPE_FLOAT_INPUT);
    const XrAction stick = make_action(set, "stick", XR_ACTION_TYPE_VECTOR2F_INPUT, {left, right});
    const XrAction x_axis = make_action(set, "x", XR_ACTION_TYPE_FLOAT_INPUT);
    ASSERT_EQ(suggest(index_profile, {{trigger, "/user/hand/left/input/trigger/value"},
                                      {trigger, "/user/hand/right/input/trigger/value"},
                                      {click, "/user/hand/left/input/a/click"},
                                      {stick, "/user/hand/left/input/thumbstick"},
                                      {stick, "/user/hand/right/input/thumbstick"},
                                      {x_axis, "/user/hand/left/input/thumbstick/x"}}),
              XR_SUCCESS);
    ASSERT_EQ(attach({set}), XR_SUCCESS);
    run_to_focus();
    xr.host->left.change([](ControllerState& state) {
        state.trigger = 0.25f;
        state.a_click = true;
        state.thumbstick = {-0.5f, 0.1f};
    });
    xr.host->right.change([](ControllerState& state) {
        state.trigger = 0.75f;
        state.thumbstick = {0.2f, 0.2f};
    });
    ASSERT_EQ(sync({{set, XR_NULL_PATH}}), XR_SUCCESS);
    EXPECT_FLOAT_EQ(scalar(trigger, left).currentState, 0.25f);
    EXPECT_FLOAT_EQ(scalar(trigger).currentState, 0.75f) << "the strongest";
    EXPECT_FLOAT_EQ(scalar(click).currentState, 1);
    EXPECT_FLOAT_EQ(scalar(x_axis).currentState, -0.5f);
    EXPECT_FLOAT_EQ(vector(stick).currentState.x, -0.5f) << "the longest";
    EXPECT_FLOAT_EQ(vector(stick, right).currentState.x, 0.2f);
    ASSERT_EQ(sync({{set, left}}), XR_SUCCESS);
    EXPECT_EQ(scalar(trigger, right).isActive, XR_FALSE) << "the set is active for the left hand only";
    EXPECT_FLOAT_EQ(scalar(trigger).currentState, 0.25f);
    ASSERT_EQ(sync({}), XR_SUCCESS);
    EXPECT_EQ(scalar(trigger).isActive, XR_FALSE);
    EXPECT_FLOAT_EQ(scalar(trigger).currentState, 0);
    EXPECT_EQ(scalar(trigger).lastChangeTime, 0);
}

TEST_F(Actions, SubactionPaths) {
    const XrAction both = make_action(set, "both", XR_ACTION_TYPE_BOOLEAN_INPUT, {left});
    const XrAction none = make_action(set, "none", XR_ACTION_TYPE_BOOLEAN_INPUT);
    ASSERT_EQ(attach({set}), XR_SUCCESS);
    run_to_focus();
    XrActionStateBoolean state{XR_TYPE_ACTION_STATE_BOOLEAN};
    XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, both, right};
    EXPECT_EQ(xr.xrGetActionStateBoolean(session, &info, &state), XR_ERROR_PATH_UNSUPPORTED);
    info.subactionPath = XrPath(0x12345);
    EXPECT_EQ(xr.xrGetActionStateBoolean(session, &info, &state), XR_ERROR_PATH_INVALID);
    info = {XR_TYPE_ACTION_STATE_GET_INFO, nullptr, none, left};
    EXPECT_EQ(xr.xrGetActionStateBoolean(session, &info, &state), XR_ERROR_PATH_UNSUPPORTED);
    EXPECT_EQ(sync({{set, right}}), XR_ERROR_PATH_UNSUPPORTED);
    EXPECT_EQ(sync({{set, XrPath(0x12345)}}), XR_ERROR_PATH_INVALID);
    EXPECT_EQ(sync({{set, left}}), XR_SUCCESS);
    const XrActionSet other = make_set("other", 0);
    EXPECT_EQ(sync({{set, XR_NULL_PATH}, {other, XR_NULL_PATH}}), XR_ERROR_ACTIONSET_NOT_ATTACHED);
}

TEST_F(Actions, PriorityOfSets) {
    const XrActionSet high_set = make_set("high", 10);
    const XrAction low = make_action(set, "low", XR_ACTION_TYPE_BOOLEAN_INPUT),
                   high = make_action(high_set, "high", XR_ACTION_TYPE_BOOLEAN_INPUT);
    const XrAction low_menu = make_action(set, "menu", XR_ACTION_TYPE_BOOLEAN_INPUT);
    ASSERT_EQ(suggest(simple_profile, {{low, "/user/hand/left/input/select/click"},
                                       {high, "/user/hand/left/input/select/click"},
                                       {low_menu, "/user/hand/left/input/menu/click"}}),
              XR_SUCCESS);
    ASSERT_EQ(attach({set, high_set}), XR_SUCCESS);
    run_to_focus();
    xr.host->left.change([](ControllerState& state) { state.select_click = state.menu_click = true; });
    ASSERT_EQ(sync({{set, XR_NULL_PATH}, {high_set, XR_NULL_PATH}}), XR_SUCCESS);
    EXPECT_EQ(high ? boolean(high).currentState : XR_FALSE, XR_TRUE);
    EXPECT_EQ(boolean(low).isActive, XR_FALSE);
    EXPECT_EQ(boolean(low_menu).currentState, XR_TRUE);
    ASSERT_EQ(sync({{set, XR_NULL_PATH}}), XR_SUCCESS);
    EXPECT_EQ(boolean(low).currentState, XR_TRUE);
    EXPECT_EQ(boolean(high).isActive, XR_FALSE);
}

TEST_F(Actions, ProfileIsTheMostCapableSuggested) {
    const XrAction action = make_action(set, "a", XR_ACTION_TYPE_BOOLEAN_INPUT);
    ASSERT_EQ(suggest(simple_profile, {{action, "/user/hand/left/input/select/click"}}), XR_SUCCESS);
    ASSERT_EQ(suggest("/interaction_profiles/oculus/touch_controller", {{action, "/user/hand/left/input/x/click"}}), XR_SUCCESS);
    ASSERT_EQ(suggest("/interaction_profiles/htc/vive_controller", {{action, "/user/hand/left/input/trigger/click"}}), XR_SUCCESS);
    ASSERT_EQ(attach({set}), XR_SUCCESS);
    run_to_focus();
    ASSERT_EQ(sync({{set, XR_NULL_PATH}}), XR_SUCCESS);
    EXPECT_EQ(profile_of(left), "/interaction_profiles/htc/vive_controller");
    EXPECT_EQ(profile_of(xr.path("/user/gamepad")), "");
}

TEST_F(Actions, AControllerComesAndGoes) {
    const XrAction action = make_action(set, "pose", XR_ACTION_TYPE_POSE_INPUT, {left, right});
    ASSERT_EQ(suggest(index_profile, {{action, "/user/hand/left/input/grip/pose"}, {action, "/user/hand/right/input/grip/pose"}}),
              XR_SUCCESS);
    ASSERT_EQ(attach({set}), XR_SUCCESS);
    run_to_focus();
    const XrActionSpaceCreateInfo info{XR_TYPE_ACTION_SPACE_CREATE_INFO, nullptr, action, left, {{0, 0, 0, 1}, {0, 0, 0}}};
    XrSpace space = XR_NULL_HANDLE;
    ASSERT_EQ(xr.xrCreateActionSpace(session, &info, &space), XR_SUCCESS);
    const XrSpace local = reference_space(XR_REFERENCE_SPACE_TYPE_LOCAL);
    xr.host->left.change([](ControllerState& state) { state.grip.pose.position = {0, 2.2f, -1}; });
    ASSERT_EQ(sync({{set, XR_NULL_PATH}}), XR_SUCCESS);
    EXPECT_EQ(locate(space, local, now()).locationFlags, 0xfu);
    EXPECT_NEAR(locate(space, local, now()).pose.position.y, 1, 1e-6) << "LOCAL is at the head, 1.2 m above the floor";
    static_cast<void>(profile_events());
    xr.host->left.change([](ControllerState& state) { state.active = false; });
    EXPECT_EQ(locate(space, local, now()).locationFlags, 0u);
    ASSERT_EQ(sync({{set, XR_NULL_PATH}}), XR_SUCCESS);
    EXPECT_EQ(profile_events(), 1);
    EXPECT_EQ(profile_of(left), "");
    EXPECT_EQ(profile_of(right), index_profile);
    xr.host->left.change([](ControllerState& state) { state.active = true; });
    ASSERT_EQ(sync({{set, XR_NULL_PATH}}), XR_SUCCESS);
    EXPECT_EQ(profile_of(left), index_profile);
    EXPECT_EQ(xr.xrDestroyAction(action), XR_SUCCESS);
    EXPECT_EQ(locate(space, local, now()).locationFlags, 0xfu) << "the space outlives the action's handle";
    ASSERT_EQ(sync({}), XR_SUCCESS);
    EXPECT_EQ(locate(space, local, now()).locationFlags, 0u) << "no set is active";
}

TEST_F(Actions, ActionSpaceErrors) {
    const XrAction pose = make_action(set, "pose", XR_ACTION_TYPE_POSE_INPUT, {left}),
                   click = make_action(set, "click", XR_ACTION_TYPE_BOOLEAN_INPUT);
    XrSpace space = XR_NULL_HANDLE;
    XrActionSpaceCreateInfo info{XR_TYPE_ACTION_SPACE_CREATE_INFO, nullptr, click, XR_NULL_PATH, {{0, 0, 0, 1}, {0, 0, 0}}};
    EXPECT_EQ(xr.xrCreateActionSpace(session, &info, &space), XR_ERROR_ACTION_TYPE_MISMATCH);
    info.action = pose;
    info.subactionPath = right;
    EXPECT_EQ(xr.xrCreateActionSpace(session, &info, &space), XR_ERROR_PATH_UNSUPPORTED);
    info.subactionPath = XrPath(0x12345);
    EXPECT_EQ(xr.xrCreateActionSpace(session, &info, &space), XR_ERROR_PATH_INVALID);
    info.subactionPath = left;
    info.poseInActionSpace.orientation.w = 2;
    EXPECT_EQ(xr.xrCreateActionSpace(session, &info, &space), XR_ERROR_POSE_INVALID);
    info.action = XR_NULL_HANDLE;
    EXPECT_EQ(xr.xrCreateActionSpace(session, &info, &space), XR_ERROR_HANDLE_INVALID);
}

TEST_F(Actions, Haptics) {
    const XrAction buzz = make_action(set, "buzz", XR_ACTION_TYPE_VIBRATION_OUTPUT, {left, right});
    const XrAction click = make_action(set, "click", XR_ACTION_TYPE_BOOLEAN_INPUT);
    ASSERT_EQ(suggest(simple_profile, {{buzz, "/user/hand/left/output/haptic"}, {buzz, "/user/hand/right/output/haptic"}}), XR_SUCCESS);
    ASSERT_EQ(attach({set}), XR_SUCCESS);
    XrHapticActionInfo info{XR_TYPE_HAPTIC_ACTION_INFO, nullptr, buzz, left};
    XrHapticVibration vibration{XR_TYPE_HAPTIC_VIBRATION, nullptr, 1000, 50, 0.5f};
    const auto apply = [&] { return xr.xrApplyHapticFeedback(session, &info, reinterpret_cast<const XrHapticBaseHeader*>(&vibration)); };
    EXPECT_EQ(apply(), XR_SESSION_NOT_FOCUSED);
    run_to_focus();
    ASSERT_EQ(sync({{set, XR_NULL_PATH}}), XR_SUCCESS);
    EXPECT_EQ(apply(), XR_SUCCESS);
    ASSERT_EQ(xr.host->left.vibrations.size(), 1u);
    EXPECT_EQ(xr.host->left.vibrations[0].duration, 1000);
    EXPECT_EQ(xr.host->left.vibrations[0].time, now());
    EXPECT_TRUE(xr.host->right.vibrations.empty());
    info.subactionPath = XR_NULL_PATH;
    vibration.duration = XR_MIN_HAPTIC_DURATION;
    EXPECT_EQ(apply(), XR_SUCCESS);
    EXPECT_EQ(xr.host->right.vibrations.size(), 1u);
    EXPECT_GT(xr.host->right.vibrations[0].duration, 0);
    EXPECT_EQ(xr.xrStopHapticFeedback(session, &info), XR_SUCCESS);
    EXPECT_FLOAT_EQ(xr.host->right.vibrations.back().amplitude, 0);
    vibration.amplitude = 0.0f / 0.0f;
    EXPECT_EQ(apply(), XR_ERROR_VALIDATION_FAILURE);
    vibration.amplitude = 1;
    vibration.duration = -5;
    EXPECT_EQ(apply(), XR_ERROR_VALIDATION_FAILURE);
    vibration.type = XR_TYPE_UNKNOWN;
    EXPECT_EQ(apply(), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrApplyHapticFeedback(session, &info, nullptr), XR_ERROR_VALIDATION_FAILURE);
    info.action = click;
    EXPECT_EQ(apply(), XR_ERROR_ACTION_TYPE_MISMATCH);
}

TEST_F(Actions, BoundSourcesAndTheirNames) {
    const XrAction action = make_action(set, "a", XR_ACTION_TYPE_BOOLEAN_INPUT);
    ASSERT_EQ(suggest(index_profile, {{action, "/user/hand/left/input/trigger/click"}, {action, "/user/hand/right/input/a/click"}}),
              XR_SUCCESS);
    ASSERT_EQ(attach({set}), XR_SUCCESS);
    run_to_focus();
    const XrBoundSourcesForActionEnumerateInfo info{XR_TYPE_BOUND_SOURCES_FOR_ACTION_ENUMERATE_INFO, nullptr, action};
    std::uint32_t count = 9;
    ASSERT_EQ(xr.xrEnumerateBoundSourcesForAction(session, &info, 0, &count, nullptr), XR_SUCCESS);
    EXPECT_EQ(count, 0u) << "no profile is current before the first sync";
    ASSERT_EQ(sync({{set, XR_NULL_PATH}}), XR_SUCCESS);
    std::vector<XrPath> sources(2);
    ASSERT_EQ(xr.xrEnumerateBoundSourcesForAction(session, &info, 2, &count, sources.data()), XR_SUCCESS);
    ASSERT_EQ(count, 2u);
    EXPECT_EQ(xr.text(sources[0]), "/user/hand/left/input/trigger/click");
    EXPECT_EQ(xr.xrEnumerateBoundSourcesForAction(session, &info, 1, &count, sources.data()), XR_ERROR_SIZE_INSUFFICIENT);
    XrInputSourceLocalizedNameGetInfo name{XR_TYPE_INPUT_SOURCE_LOCALIZED_NAME_GET_INFO, nullptr, sources[0], 7};
    char text[128];
    ASSERT_EQ(xr.xrGetInputSourceLocalizedName(session, &name, sizeof(text), &count, text), XR_SUCCESS);
    EXPECT_STREQ(text, "Left Hand Valve Index Controller Trigger");
    EXPECT_EQ(xr.xrGetInputSourceLocalizedName(session, &name, 3, &count, text), XR_ERROR_SIZE_INSUFFICIENT);
    name.whichComponents = 0;
    EXPECT_EQ(xr.xrGetInputSourceLocalizedName(session, &name, sizeof(text), &count, text), XR_ERROR_VALIDATION_FAILURE);
    name.whichComponents = 1;
    name.sourcePath = XR_NULL_PATH;
    EXPECT_EQ(xr.xrGetInputSourceLocalizedName(session, &name, sizeof(text), &count, text), XR_ERROR_PATH_INVALID);
}

TEST_F(Actions, LosingFocusReleasesEverything) {
    const XrAction action = make_action(set, "a", XR_ACTION_TYPE_BOOLEAN_INPUT);
    ASSERT_EQ(suggest(simple_profile, {{action, "/user/hand/left/input/select/click"}}), XR_SUCCESS);
    ASSERT_EQ(attach({set}), XR_SUCCESS);
    run_to_focus();
    xr.host->left.change([](ControllerState& state) { state.select_click = true; });
    ASSERT_EQ(sync({{set, XR_NULL_PATH}}), XR_SUCCESS);
    EXPECT_EQ(boolean(action).currentState, XR_TRUE);
    EXPECT_EQ(xr.xrRequestExitSession(session), XR_SUCCESS);
    EXPECT_EQ(boolean(action).isActive, XR_FALSE);
    EXPECT_EQ(sync({{set, XR_NULL_PATH}}), XR_SESSION_NOT_FOCUSED);
}

TEST_F(Actions, ASecondSessionMayAttachTheSameSets) {
    ASSERT_EQ(attach({set}), XR_SUCCESS);
    EXPECT_EQ(xr.xrDestroySession(session), XR_SUCCESS);
    session = make_session();
    EXPECT_EQ(attach({set}), XR_SUCCESS);
}

}  // namespace
}  // namespace entoptic::runtime::testing
