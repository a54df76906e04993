// labels: gpu
// A client that knows the API and means harm: every entry point with living, destroyed and invented handles, wrong structure types, numbers of
// every kind, in any order. Whatever it does, the answer is a code of the specification and the session goes on. Build with the preset `asan`
// to see what no code tells; ENTOPTIC_FUZZ_CALLS and ENTOPTIC_FUZZ_SEED make longer and other runs.
#include "entoptic/XR_ENTOPTICX_observer.h"
#include "entoptic/XR_ENTOPTICX_presentation_timing.h"
#include "runtime/objects/handle_table.h"
#include "runtime/testing/client.h"

#include <cstdlib>
#include <limits>
#include <random>

namespace entoptic::runtime::testing {
namespace {

const std::vector<const char*> extensions{"XR_KHR_vulkan_enable2",
                                          "XR_EXT_conformance_automation",
                                          "XR_KHR_binding_modification",
                                          "XR_EXT_dpad_binding",
                                          "XR_KHR_visibility_mask",
                                          "XR_FB_display_refresh_rate",
                                          "XR_KHR_composition_layer_cylinder",
                                          "XR_KHR_composition_layer_equirect",
                                          "XR_KHR_composition_layer_equirect2",
                                          "XR_KHR_composition_layer_cube",
                                          "XR_KHR_composition_layer_depth",
                                          "XR_KHR_composition_layer_color_scale_bias",
                                          "XR_EXT_eye_gaze_interaction",
                                          "XR_ENTOPTICX_observer",
                                          "XR_ENTOPTICX_presentation_timing"};

long from_environment(const char* name, long otherwise) {
    const char* text = std::getenv(name);
    return text ? std::strtol(text, nullptr, 10) : otherwise;
}

class Fuzz : public SessionTest {
public:
    Fuzz() : SessionTest(extensions, XR_MAKE_VERSION(1, 1, 0)) {}

    std::uint32_t below(std::uint32_t n) { return std::uniform_int_distribution<std::uint32_t>(0, n - 1)(random); }
    bool seldom() { return below(40) == 0; }
    float number() {
        constexpr float inf = std::numeric_limits<float>::infinity();
        constexpr std::array values{0.0f,  1.0f,   -1.0f,  0.5f, -0.2f, 3.0f,
                                    1e30f, -1e30f, 1e-30f, inf,  -inf,  std::numeric_limits<float>::quiet_NaN()};
        return seldom() ? values[below(values.size())] : std::uniform_real_distribution<float>(0, 1)(random);
    }
    XrPosef pose() {
        return seldom() ? XrPosef{{number(), number(), number(), number()}, {number(), number(), number()}}
                        : XrPosef{{0, 0, 0, 1}, {number(), 0, 0}};
    }
    XrTime time() {
        constexpr std::array<XrTime, 5> values{0, -1, 1, std::numeric_limits<XrTime>::max(), std::numeric_limits<XrTime>::min()};
        return seldom() ? values[below(values.size())] : now() + XrTime(below(20'000'000));
    }
    std::int32_t integer() {
        constexpr std::array<std::int32_t, 6> values{
            0, -1, 1, 1 << 20, std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min()};
        return seldom() ? values[below(values.size())] : std::int32_t(below(32));
    }
    XrStructureType type(XrStructureType right) { return seldom() ? XrStructureType(below(80)) : right; }
    template <class Enum> Enum one_of(std::initializer_list<Enum> right) {
        return seldom() ? static_cast<Enum>(integer()) : right.begin()[below(std::uint32_t(right.size()))];
    }
    // A living handle, one that was destroyed, one of another type, or an invented one.
    template <class Handle> Handle pick(const std::vector<Handle>& known) {
        if (!known.empty() && !seldom()) return known[below(std::uint32_t(known.size()))];
        const std::array<std::uint64_t, 5> others{0, random(), handle_value(session), handle_value(xr.instance), 0x1234};
        return to_handle<Handle>(others[below(others.size())]);
    }
    template <class Handle> void keep(XrResult result, Handle handle, std::vector<Handle>& list) {
        check(result);
        if (result != XR_SUCCESS) return;
        if (list.size() < 8)
            list.push_back(handle);
        else
            list[below(8)] = handle;  // the old one lives on, unknown
    }
    void check(XrResult result) {
        ++calls;
        char name[XR_MAX_RESULT_STRING_SIZE] = "";
        ASSERT_EQ(xr.xrResultToString(xr.instance, result, name), XR_SUCCESS);
        EXPECT_FALSE(std::string_view(name).starts_with("XR_UNKNOWN")) << result;
        EXPECT_NE(result, XR_ERROR_RUNTIME_FAILURE);
    }
    XrPath any_path() {
        static const char* const texts[] = {"/user/hand/left",
                                            "/user/hand/right",
                                            "/user/head",
                                            "/user/gamepad",
                                            "/user/eyes_ext",
                                            "/user/hand/left/input/trigger/value",
                                            "/user/hand/left/input/grip/pose",
                                            "/user/hand/right/input/thumbstick",
                                            "/user/hand/left/input/trackpad/dpad_up",
                                            "/interaction_profiles/valve/index_controller",
                                            "/interaction_profiles/khr/simple_controller",
                                            "/a"};
        return seldom() ? XrPath(random()) : xr.path(texts[below(std::size(texts))]);
    }

    void make_things();
    void input();
    void locating();
    void images();
    void frames();
    void submit();
    void asking();

    std::mt19937_64 random{std::uint64_t(from_environment("ENTOPTIC_FUZZ_SEED", 1))};
    std::vector<XrSpace> spaces;
    std::vector<XrSwapchain> swapchains;
    std::vector<XrActionSet> sets;
    std::vector<XrAction> actions;
    long calls = 0;
};

void Fuzz::make_things() {
    XrReferenceSpaceCreateInfo reference{
        type(XR_TYPE_REFERENCE_SPACE_CREATE_INFO), nullptr,
        one_of({XR_REFERENCE_SPACE_TYPE_VIEW, XR_REFERENCE_SPACE_TYPE_LOCAL, XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR}), pose()};
    XrSpace space = XR_NULL_HANDLE;
    keep(xr.xrCreateReferenceSpace(session, &reference, seldom() ? nullptr : &space), space, spaces);
    if (space == XR_NULL_HANDLE && !spaces.empty()) spaces.pop_back();
    if (!spaces.empty() && seldom()) check(xr.xrDestroySpace(spaces[below(std::uint32_t(spaces.size()))]));  // and it stays in the list
    const XrActionSpaceCreateInfo action_space{type(XR_TYPE_ACTION_SPACE_CREATE_INFO), nullptr, pick(actions),
                                               seldom() ? any_path() : XR_NULL_PATH, pose()};
    space = XR_NULL_HANDLE;
    if (const XrResult made = xr.xrCreateActionSpace(session, &action_space, &space); made == XR_SUCCESS)
        keep(made, space, spaces);
    else
        check(made);
    if (below(4) != 0) return;
    XrSwapchainCreateInfo info = swapchain_info();
    info.type = type(info.type);
    info.faceCount = seldom() ? 6 : 1;
    if (seldom()) info.width = std::uint32_t(integer());
    if (seldom()) info.format = integer();
    if (seldom()) info.usageFlags = random();
    if (seldom()) info.arraySize = std::uint32_t(integer());
    if (seldom()) info.mipCount = below(9);
    if (info.width > 4096 || info.arraySize > 64)
        info.arraySize = 1, info.width = info.width > 16384 ? info.width : 64;  // keeps the memory small
    XrSwapchain swapchain = XR_NULL_HANDLE;
    const XrResult made = xr.xrCreateSwapchain(session, &info, &swapchain);
    if (made != XR_SUCCESS) {
        check(made);
    } else if (swapchains.size() < 4) {
        keep(made, swapchain, swapchains);
    } else {  // the oldest goes, if it was not gone already
        check(xr.xrDestroySwapchain(swapchains.front()));
        swapchains.erase(swapchains.begin());
        swapchains.push_back(swapchain);
    }
}

void Fuzz::input() {
    XrActionSetCreateInfo set_info{type(XR_TYPE_ACTION_SET_CREATE_INFO)};
    std::snprintf(set_info.actionSetName, sizeof(set_info.actionSetName), "set%u", below(20));
    std::snprintf(set_info.localizedActionSetName, sizeof(set_info.localizedActionSetName), "Set %u", below(20));
    if (seldom()) std::memset(set_info.actionSetName, 0xff, sizeof(set_info.actionSetName));
    XrActionSet set = XR_NULL_HANDLE;
    if (const XrResult made = xr.xrCreateActionSet(xr.instance, &set_info, &set); made == XR_SUCCESS) keep(made, set, sets);
    XrActionCreateInfo info{type(XR_TYPE_ACTION_CREATE_INFO)};
    std::snprintf(info.actionName, sizeof(info.actionName), "action%u", below(40));
    std::snprintf(info.localizedActionName, sizeof(info.localizedActionName), "Action %u", below(40));
    info.actionType =
        one_of({XR_ACTION_TYPE_BOOLEAN_INPUT, XR_ACTION_TYPE_FLOAT_INPUT, XR_ACTION_TYPE_POSE_INPUT, XR_ACTION_TYPE_VIBRATION_OUTPUT});
    const std::array<XrPath, 2> users{any_path(), any_path()};
    info.countSubactionPaths = below(3);
    info.subactionPaths = seldom() ? nullptr : users.data();
    XrAction action = XR_NULL_HANDLE;
    if (const XrResult made = xr.xrCreateAction(pick(sets), &info, &action); made == XR_SUCCESS) keep(made, action, actions);
    const std::array<XrActionSuggestedBinding, 2> bindings{{{pick(actions), any_path()}, {pick(actions), any_path()}}};
    XrInteractionProfileDpadBindingEXT dpad{type(XR_TYPE_INTERACTION_PROFILE_DPAD_BINDING_EXT),
                                            nullptr,
                                            any_path(),
                                            pick(sets),
                                            number(),
                                            number(),
                                            number(),
                                            number(),
                                            XR_TRUE,
                                            nullptr,
                                            nullptr};
    const auto* header = reinterpret_cast<const XrBindingModificationBaseHeaderKHR*>(&dpad);
    const XrBindingModificationsKHR modifications{XR_TYPE_BINDING_MODIFICATIONS_KHR, nullptr, below(2), seldom() ? nullptr : &header};
    const XrInteractionProfileSuggestedBinding suggest{type(XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING), &modifications, any_path(),
                                                       below(3), seldom() ? nullptr : bindings.data()};
    check(xr.xrSuggestInteractionProfileBindings(xr.instance, &suggest));
    const std::array<XrActionSet, 2> some{pick(sets), pick(sets)};
    const XrSessionActionSetsAttachInfo attach{type(XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO), nullptr, below(3), some.data()};
    if (seldom()) check(xr.xrAttachSessionActionSets(session, &attach));
    const std::array<XrActiveActionSet, 2> active{{{some[0], XR_NULL_PATH}, {some[1], seldom() ? any_path() : XR_NULL_PATH}}};
    const XrActionsSyncInfo sync{type(XR_TYPE_ACTIONS_SYNC_INFO), nullptr, below(3), seldom() ? nullptr : active.data()};
    check(xr.xrSyncActions(session, &sync));
    const XrActionStateGetInfo get{type(XR_TYPE_ACTION_STATE_GET_INFO), nullptr, pick(actions), seldom() ? any_path() : XR_NULL_PATH};
    XrActionStateBoolean boolean{type(XR_TYPE_ACTION_STATE_BOOLEAN)};
    XrActionStateFloat scalar{type(XR_TYPE_ACTION_STATE_FLOAT)};
    XrActionStatePose pose_state{type(XR_TYPE_ACTION_STATE_POSE)};
    check(xr.xrGetActionStateBoolean(session, &get, &boolean));
    check(xr.xrGetActionStateFloat(session, &get, &scalar));
    check(xr.xrGetActionStatePose(session, &get, seldom() ? nullptr : &pose_state));
    const XrHapticActionInfo haptic{type(XR_TYPE_HAPTIC_ACTION_INFO), nullptr, pick(actions), XR_NULL_PATH};
    const XrHapticVibration vibration{type(XR_TYPE_HAPTIC_VIBRATION), nullptr, time(), number(), number()};
    check(xr.xrApplyHapticFeedback(session, &haptic, reinterpret_cast<const XrHapticBaseHeader*>(&vibration)));
    check(xr.get<PFN_xrSetInputDeviceActiveEXT>("xrSetInputDeviceActiveEXT")(session, any_path(), any_path(), below(3)));
    check(xr.get<PFN_xrSetInputDeviceStateFloatEXT>("xrSetInputDeviceStateFloatEXT")(session, any_path(), any_path(), number()));
    check(xr.get<PFN_xrSetInputDeviceLocationEXT>("xrSetInputDeviceLocationEXT")(session, any_path(), any_path(), pick(spaces), pose()));
    if (!actions.empty() && seldom()) check(xr.xrDestroyAction(pick(actions)));
    if (!sets.empty() && below(40) == 0) check(xr.xrDestroyActionSet(pick(sets)));
}

void Fuzz::locating() {
    XrSpaceVelocity velocity{type(XR_TYPE_SPACE_VELOCITY)};
    XrSpaceLocation location{type(XR_TYPE_SPACE_LOCATION), seldom() ? nullptr : &velocity};
    check(xr.xrLocateSpace(pick(spaces), pick(spaces), time(), &location));
    const std::array<XrSpace, 3> some{pick(spaces), pick(spaces), pick(spaces)};
    std::array<XrSpaceLocationData, 3> data{};
    XrSpaceLocations locations{type(XR_TYPE_SPACE_LOCATIONS), nullptr, below(4), seldom() ? nullptr : data.data()};
    const XrSpacesLocateInfo info{type(XR_TYPE_SPACES_LOCATE_INFO), nullptr, pick(spaces), time(), below(4), some.data()};
    check(xr.get<PFN_xrLocateSpaces>("xrLocateSpaces")(session, &info, &locations));
    const auto views_type =
        one_of({XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO_WITH_FOVEATED_INSET});
    const XrViewLocateInfo views_info{type(XR_TYPE_VIEW_LOCATE_INFO), nullptr, views_type, time(), pick(spaces)};
    std::array<XrView, 4> views;
    views.fill({type(XR_TYPE_VIEW)});
    XrViewState state{type(XR_TYPE_VIEW_STATE)};
    std::uint32_t count = 0;
    check(xr.xrLocateViews(session, &views_info, &state, below(5), seldom() ? nullptr : &count, seldom() ? nullptr : views.data()));
    const XrObserverGetInfoENTOPTICX observer_info{type(XR_TYPE_OBSERVER_GET_INFO_ENTOPTICX), nullptr, pick(spaces), time()};
    XrObserverENTOPTICX observer{type(XR_TYPE_OBSERVER_ENTOPTICX)};
    check(xr.get<PFN_xrGetObserverENTOPTICX>("xrGetObserverENTOPTICX")(session, &observer_info, seldom() ? nullptr : &observer));
    std::array<XrVector2f, 256> vertices;
    std::array<std::uint32_t, 512> indices;
    XrVisibilityMaskKHR mask{type(XR_TYPE_VISIBILITY_MASK_KHR), nullptr, below(257), 0, vertices.data(), below(513), 0, indices.data()};
    check(xr.get<PFN_xrGetVisibilityMaskKHR>("xrGetVisibilityMaskKHR")(session, views_type, below(5),
                                                                       static_cast<XrVisibilityMaskTypeKHR>(below(5)), &mask));
}

void Fuzz::images() {
    const XrSwapchain swapchain = pick(swapchains);
    std::uint32_t index = 0, count = 0;
    check(xr.xrAcquireSwapchainImage(swapchain, nullptr, seldom() ? nullptr : &index));
    const XrSwapchainImageWaitInfo wait{type(XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO), nullptr, seldom() ? integer() : 0};
    if (!seldom()) check(xr.xrWaitSwapchainImage(swapchain, &wait));
    if (!seldom()) check(xr.xrReleaseSwapchainImage(swapchain, nullptr));
    std::array<XrSwapchainImageVulkanKHR, 3> made;
    made.fill({type(XR_TYPE_SWAPCHAIN_IMAGE_VULKAN_KHR)});
    check(xr.xrEnumerateSwapchainImages(swapchain, below(4), &count, reinterpret_cast<XrSwapchainImageBaseHeader*>(made.data())));
    if (below(30) == 0) check(xr.xrDestroySwapchain(swapchain));
}

// Up to four layers of any kind with any numbers.
void Fuzz::submit() {
    const auto sub = [&]() -> XrSwapchainSubImage {
        return {pick(swapchains), {{seldom() ? integer() : 0, 0}, {seldom() ? integer() : 16, 16}}, seldom() ? below(9) : 0};
    };
    const auto flags = [&] { return seldom() ? random() : std::uint64_t(below(8)); };
    const auto eyes = [&] { return one_of({XR_EYE_VISIBILITY_BOTH, XR_EYE_VISIBILITY_LEFT}); };
    const XrCompositionLayerColorScaleBiasKHR tint{
        XR_TYPE_COMPOSITION_LAYER_COLOR_SCALE_BIAS_KHR, nullptr, {number(), 1, 1, 1}, {0, 0, number(), 0}};
    const XrCompositionLayerDepthInfoKHR depth{
        XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR, nullptr, sub(), number(), number(), number(), number()};
    std::array<XrCompositionLayerProjectionView, 4> views;
    for (auto& view : views)
        view = {type(XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW),
                seldom() ? &depth : nullptr,
                pose(),
                {-number(), number(), number(), -number()},
                sub()};
    const XrCompositionLayerProjection projection{
        XR_TYPE_COMPOSITION_LAYER_PROJECTION, &tint, flags(), pick(spaces), seldom() ? below(5) : 2, seldom() ? nullptr : views.data()};
    const XrCompositionLayerQuad quad{
        XR_TYPE_COMPOSITION_LAYER_QUAD, nullptr, flags(), pick(spaces), eyes(), sub(), pose(), {number(), number()}};
    const XrCompositionLayerCylinderKHR cylinder{
        XR_TYPE_COMPOSITION_LAYER_CYLINDER_KHR, &tint, flags(), pick(spaces), eyes(), sub(), pose(), number(), number(), number()};
    const XrCompositionLayerEquirectKHR equirect{XR_TYPE_COMPOSITION_LAYER_EQUIRECT_KHR,
                                                 nullptr,
                                                 flags(),
                                                 pick(spaces),
                                                 eyes(),
                                                 sub(),
                                                 pose(),
                                                 number(),
                                                 {number(), number()},
                                                 {number(), number()}};
    const XrCompositionLayerEquirect2KHR second{XR_TYPE_COMPOSITION_LAYER_EQUIRECT2_KHR,
                                                nullptr,
                                                flags(),
                                                pick(spaces),
                                                eyes(),
                                                sub(),
                                                pose(),
                                                number(),
                                                number(),
                                                number(),
                                                -number()};
    const XrCompositionLayerCubeKHR cube{
        XR_TYPE_COMPOSITION_LAYER_CUBE_KHR, nullptr, flags(), pick(spaces), eyes(), pick(swapchains), below(3), pose().orientation};
    const std::array<const void*, 7> all{&projection, &quad, &cylinder, &equirect, &second, &cube, nullptr};
    std::array<const XrCompositionLayerBaseHeader*, 4> layers;
    for (auto& layer : layers) layer = static_cast<const XrCompositionLayerBaseHeader*>(all[below(seldom() ? 7 : 6)]);
    const XrFrameEndInfo info{
        type(XR_TYPE_FRAME_END_INFO),      nullptr, time(), one_of({XR_ENVIRONMENT_BLEND_MODE_OPAQUE}), seldom() ? below(5) : 1,
        seldom() ? nullptr : layers.data()};
    check(xr.xrEndFrame(session, &info));
}

// Never waits for a frame twice without beginning one: that call would rightly block.
void Fuzz::frames() {
    XrFrameState state{XR_TYPE_FRAME_STATE};
    check(xr.xrWaitFrame(session, nullptr, &state));
    check(xr.xrBeginFrame(session, nullptr));
    if (seldom()) check(xr.xrBeginFrame(session, nullptr));
    submit();
    if (seldom()) submit();
}

void Fuzz::asking() {
    std::uint32_t count = 0;
    char buffer[64];
    check(xr.xrPathToString(xr.instance, any_path(), below(65), &count, buffer));
    XrInteractionProfileState profile{type(XR_TYPE_INTERACTION_PROFILE_STATE)};
    check(xr.xrGetCurrentInteractionProfile(session, any_path(), &profile));
    const XrInputSourceLocalizedNameGetInfo name{type(XR_TYPE_INPUT_SOURCE_LOCALIZED_NAME_GET_INFO), nullptr, any_path(), below(9)};
    check(xr.xrGetInputSourceLocalizedName(session, &name, below(65), &count, buffer));
    const XrPresentationTimingGetInfoENTOPTICX after{type(XR_TYPE_PRESENTATION_TIMING_GET_INFO_ENTOPTICX), nullptr, time()};
    std::array<XrPresentationTimingENTOPTICX, 8> timings;
    check(xr.get<PFN_xrEnumeratePresentationTimingsENTOPTICX>("xrEnumeratePresentationTimingsENTOPTICX")(session, &after, below(9), &count,
                                                                                                         timings.data()));
    check(xr.get<PFN_xrRequestDisplayRefreshRateFB>("xrRequestDisplayRefreshRateFB")(session, number()));
    std::array<XrViewConfigurationView, 4> views;
    views.fill({type(XR_TYPE_VIEW_CONFIGURATION_VIEW)});
    check(xr.xrEnumerateViewConfigurationViews(xr.instance, XrSystemId(integer()), one_of({XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO}),
                                               below(5), &count, views.data()));
    XrEventDataBuffer event{type(XR_TYPE_EVENT_DATA_BUFFER)};
    check(xr.xrPollEvent(xr.instance, &event));
}

TEST_F(Fuzz, EveryEntryPointInAnyOrder) {
    ASSERT_EQ(begin_session(), XR_SUCCESS);
    const long wanted = from_environment("ENTOPTIC_FUZZ_CALLS", 50'000);
    void (Fuzz::*const steps[])() = {&Fuzz::make_things, &Fuzz::input, &Fuzz::locating, &Fuzz::images, &Fuzz::frames, &Fuzz::asking};
    while (calls < wanted && !HasFatalFailure()) (this->*steps[below(std::size(steps))])();
    EXPECT_GT(xr.host->service.submitted_count, 40) << "most of what is tried must not fail at once, or nothing is tested";
    EXPECT_FALSE(swapchains.empty());
    // The session is as good as new.
    const XrSpace local = reference_space(XR_REFERENCE_SPACE_TYPE_LOCAL);
    EXPECT_NE(locate(local, local, now()).locationFlags, 0u);
    EXPECT_EQ(frame(), XR_SUCCESS);
    EXPECT_TRUE(xr.host->errors.empty()) << xr.host->errors.front();
}

}  // namespace
}  // namespace entoptic::runtime::testing
