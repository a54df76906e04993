// labels: gpu
// Devices that the application plays itself (XR_EXT_conformance_automation), the profiles of 1.1, and direction pads.
#include "runtime/testing/client.h"

#include <cmath>

namespace entoptic::runtime::testing {
namespace {

constexpr XrPosef identity{{0, 0, 0, 1}, {0, 0, 0}};
const char* const pico = "/interaction_profiles/bytedance/pico4_controller";
const char* const index_controller = "/interaction_profiles/valve/index_controller";

class Automation : public SessionTest {
public:
    Automation()
        : SessionTest({"XR_KHR_vulkan_enable2", "XR_EXT_conformance_automation", "XR_KHR_binding_modification", "XR_EXT_dpad_binding"},
                      XR_MAKE_VERSION(1, 1, 0)) {}
    void SetUp() override {
        SessionTest::SetUp();
        XrActionSetCreateInfo info{XR_TYPE_ACTION_SET_CREATE_INFO, nullptr, "set", "Set", 0};
        ASSERT_EQ(xr.xrCreateActionSet(xr.instance, &info, &set), XR_SUCCESS);
        set_active = xr.get<PFN_xrSetInputDeviceActiveEXT>("xrSetInputDeviceActiveEXT");
        set_float = xr.get<PFN_xrSetInputDeviceStateFloatEXT>("xrSetInputDeviceStateFloatEXT");
        set_bool = xr.get<PFN_xrSetInputDeviceStateBoolEXT>("xrSetInputDeviceStateBoolEXT");
        set_vector = xr.get<PFN_xrSetInputDeviceStateVector2fEXT>("xrSetInputDeviceStateVector2fEXT");
        set_location = xr.get<PFN_xrSetInputDeviceLocationEXT>("xrSetInputDeviceLocationEXT");
    }
    XrAction action(const char* name, XrActionType type) {
        XrActionCreateInfo info{XR_TYPE_ACTION_CREATE_INFO};
        std::strcpy(info.actionName, name);
        std::strcpy(info.localizedActionName, name);
        info.actionType = type;
        XrAction made = XR_NULL_HANDLE;
        EXPECT_EQ(xr.xrCreateAction(set, &info, &made), XR_SUCCESS);
        return made;
    }
    XrResult suggest(const char* profile, std::vector<XrActionSuggestedBinding> bindings, const void* chain = nullptr) {
        const XrInteractionProfileSuggestedBinding info{XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, chain, xr.path(profile),
                                                        std::uint32_t(bindings.size()), bindings.data()};
        return xr.xrSuggestInteractionProfileBindings(xr.instance, &info);
    }
    void attach() {
        const XrSessionActionSetsAttachInfo info{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, 1, &set};
        EXPECT_EQ(xr.xrAttachSessionActionSets(session, &info), XR_SUCCESS);
        run_to_focus();
        sync();
    }
    void sync() {
        const XrActiveActionSet active{set, XR_NULL_PATH};
        const XrActionsSyncInfo info{XR_TYPE_ACTIONS_SYNC_INFO, nullptr, 1, &active};
        EXPECT_EQ(xr.xrSyncActions(session, &info), XR_SUCCESS);
    }
    XrActionStateFloat float_state(XrAction of) {
        const XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, of, XR_NULL_PATH};
        XrActionStateFloat state{XR_TYPE_ACTION_STATE_FLOAT};
        EXPECT_EQ(xr.xrGetActionStateFloat(session, &info, &state), XR_SUCCESS);
        return state;
    }
    bool pressed(XrAction of) {
        const XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, of, XR_NULL_PATH};
        XrActionStateBoolean state{XR_TYPE_ACTION_STATE_BOOLEAN};
        EXPECT_EQ(xr.xrGetActionStateBoolean(session, &info, &state), XR_SUCCESS);
        return state.currentState;
    }
    std::string profile_of(const char* user) {
        XrInteractionProfileState state{XR_TYPE_INTERACTION_PROFILE_STATE};
        EXPECT_EQ(xr.xrGetCurrentInteractionProfile(session, xr.path(user), &state), XR_SUCCESS);
        return state.interactionProfile ? xr.text(state.interactionProfile) : "";
    }
    XrActionSet set = XR_NULL_HANDLE;
    PFN_xrSetInputDeviceActiveEXT set_active = nullptr;
    PFN_xrSetInputDeviceStateFloatEXT set_float = nullptr;
    PFN_xrSetInputDeviceStateBoolEXT set_bool = nullptr;
    PFN_xrSetInputDeviceStateVector2fEXT set_vector = nullptr;
    PFN_xrSetInputDeviceLocationEXT set_location = nullptr;
};

TEST_F(Automation, ADevicePlaysItsPart) {
    const XrAction trigger = action("trigger", XR_ACTION_TYPE_FLOAT_INPUT), grip = action("grip", XR_ACTION_TYPE_POSE_INPUT);
    for (const char* profile : {pico, index_controller}) {
        ASSERT_EQ(suggest(profile,
                          {{trigger, xr.path("/user/hand/left/input/trigger/value")}, {grip, xr.path("/user/hand/left/input/grip/pose")}}),
                  XR_SUCCESS);
    }
    attach();
    const XrPath left = xr.path("/user/hand/left"), value = xr.path("/user/hand/left/input/trigger/value");
    EXPECT_EQ(profile_of("/user/hand/left"), index_controller) << "the fake host's controller";
    ASSERT_EQ(set_active(session, xr.path(pico), left, XR_TRUE), XR_SUCCESS);
    ASSERT_EQ(set_float(session, left, value, 0.75f), XR_SUCCESS);
    EXPECT_EQ(profile_of("/user/hand/left"), index_controller) << "not before the next sync";
    sync();
    EXPECT_EQ(profile_of("/user/hand/left"), pico);
    EXPECT_FLOAT_EQ(float_state(trigger).currentState, 0.75f);
    // Where it was put, and in VIEW with the head.
    const XrActionSpaceCreateInfo info{XR_TYPE_ACTION_SPACE_CREATE_INFO, nullptr, grip, XR_NULL_PATH, identity};
    XrSpace hand = XR_NULL_HANDLE;
    ASSERT_EQ(xr.xrCreateActionSpace(session, &info, &hand), XR_SUCCESS);
    const XrSpace stage = reference_space(XR_REFERENCE_SPACE_TYPE_STAGE), view = reference_space(XR_REFERENCE_SPACE_TYPE_VIEW);
    const XrPath pose = xr.path("/user/hand/left/input/grip/pose");
    ASSERT_EQ(set_location(session, left, pose, stage, {{0, 0, 0, 1}, {1, 2, 3}}), XR_SUCCESS);
    EXPECT_FLOAT_EQ(locate(hand, stage, now()).pose.position.z, 3);
    ASSERT_EQ(set_location(session, left, pose, view, {{0, 0, 0, 1}, {0, 0, -1}}), XR_SUCCESS);
    EXPECT_FLOAT_EQ(locate(hand, view, now()).pose.position.z, -1);
    ASSERT_EQ(set_active(session, xr.path(pico), left, XR_FALSE), XR_SUCCESS);
    EXPECT_EQ(locate(hand, stage, now()).locationFlags, 0u);
    sync();
    EXPECT_FALSE(float_state(trigger).isActive);
    EXPECT_EQ(profile_of("/user/hand/left"), "");
}

TEST_F(Automation, BadCalls) {
    const XrPath left = xr.path("/user/hand/left"), value = xr.path("/user/hand/left/input/trigger/value");
    EXPECT_EQ(set_active(session, xr.path("/interaction_profiles/no/such"), left, XR_TRUE), XR_ERROR_PATH_UNSUPPORTED);
    EXPECT_EQ(set_active(session, xr.path(pico), xr.path("/user/gamepad"), XR_TRUE), XR_ERROR_PATH_UNSUPPORTED);
    EXPECT_EQ(set_active(session, 0xffffff, left, XR_TRUE), XR_ERROR_PATH_INVALID);
    EXPECT_EQ(set_float(session, xr.path("/user/hand/right"), value, 1), XR_ERROR_PATH_UNSUPPORTED);
    EXPECT_EQ(set_float(session, left, value, NAN), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(set_bool(XR_NULL_HANDLE, left, value, XR_TRUE), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(set_location(session, left, value, XR_NULL_HANDLE, identity), XR_ERROR_HANDLE_INVALID);
}

// The wedges of a direction pad made of a stick: 90 degrees each about its axis, none in the middle.
TEST_F(Automation, DirectionPad) {
    const XrAction up = action("up", XR_ACTION_TYPE_BOOLEAN_INPUT), right = action("right", XR_ACTION_TYPE_BOOLEAN_INPUT);
    ASSERT_EQ(suggest(index_controller, {{up, xr.path("/user/hand/left/input/thumbstick/dpad_up")},
                                         {right, xr.path("/user/hand/left/input/thumbstick/dpad_right")}}),
              XR_SUCCESS);
    attach();
    const XrPath left = xr.path("/user/hand/left"), stick = xr.path("/user/hand/left/input/thumbstick");
    ASSERT_EQ(set_active(session, xr.path(index_controller), left, XR_TRUE), XR_SUCCESS);
    const auto state = [&](float angle_deg, float radius) {
        const float a = angle_deg * 0.0174533f;
        EXPECT_EQ(set_vector(session, left, stick, {radius * std::cos(a), radius * std::sin(a)}), XR_SUCCESS);
        sync();
        return std::pair(pressed(up), pressed(right));
    };
    EXPECT_EQ(state(90, 0.4f), std::pair(false, false));
    EXPECT_EQ(state(90, 0.9f), std::pair(true, false));
    EXPECT_EQ(state(46, 0.9f), std::pair(true, false));
    EXPECT_EQ(state(44, 0.9f), std::pair(false, true));
    EXPECT_EQ(state(270, 0.9f), std::pair(false, false));
}

TEST_F(Automation, DirectionPadSettingsAreChecked) {
    const XrAction up = action("up", XR_ACTION_TYPE_BOOLEAN_INPUT);
    XrInteractionProfileDpadBindingEXT dpad{XR_TYPE_INTERACTION_PROFILE_DPAD_BINDING_EXT,
                                            nullptr,
                                            xr.path("/user/hand/left/input/trackpad"),
                                            set,
                                            0.5f,
                                            0.4f,
                                            0.5f,
                                            1.0f,
                                            XR_TRUE,
                                            nullptr,
                                            nullptr};
    const auto* header = reinterpret_cast<const XrBindingModificationBaseHeaderKHR*>(&dpad);
    const XrBindingModificationsKHR modifications{XR_TYPE_BINDING_MODIFICATIONS_KHR, nullptr, 1, &header};
    const auto result = [&] {
        return suggest(index_controller, {{up, xr.path("/user/hand/left/input/trackpad/dpad_up")}}, &modifications);
    };
    EXPECT_EQ(result(), XR_SUCCESS);
    dpad.centerRegion = 1;
    EXPECT_EQ(result(), XR_ERROR_VALIDATION_FAILURE);
    dpad.centerRegion = NAN;
    EXPECT_EQ(result(), XR_ERROR_VALIDATION_FAILURE);
    dpad.centerRegion = 0.5f;
    dpad.forceThresholdReleased = 0.6f;
    EXPECT_EQ(result(), XR_ERROR_VALIDATION_FAILURE);
    dpad.forceThresholdReleased = 0.4f;
    dpad.binding = xr.path("/user/hand/left/input/trigger");
    EXPECT_EQ(result(), XR_ERROR_PATH_UNSUPPORTED);
}

}  // namespace
}  // namespace entoptic::runtime::testing
