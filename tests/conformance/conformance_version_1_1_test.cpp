// labels: gpu
// What OpenXR 1.1 added, and the extensions it grew from: there for those who ask, absent for others.
#include "runtime/testing/client.h"

#include <cmath>
#include <set>

namespace entoptic::runtime::testing {
namespace {

constexpr XrPosef identity{{0, 0, 0, 1}, {0, 0, 0}};
constexpr XrVersion v1_0 = XR_MAKE_VERSION(1, 0, 0), v1_1 = XR_MAKE_VERSION(1, 1, 0);

std::vector<const char*> with(std::vector<const char*> more) {
    more.push_back("XR_KHR_vulkan_enable2");
    return more;
}

class Version11 : public SessionTest {
public:
    Version11() : SessionTest(with({"XR_KHR_visibility_mask", "XR_EXT_user_presence", "XR_FB_display_refresh_rate"}), v1_1) {}
};
class Version10 : public SessionTest {
public:
    Version10() : SessionTest(with({}), v1_0) {}
};

std::set<int> reference_spaces(SessionTest& test) {
    std::uint32_t count = 0;
    std::array<XrReferenceSpaceType, 8> types{};
    EXPECT_EQ(test.xr.xrEnumerateReferenceSpaces(test.session, 8, &count, types.data()), XR_SUCCESS);
    return {types.begin(), types.begin() + count};
}

TEST_F(Version10, HasNothingOf11) {
    EXPECT_FALSE(reference_spaces(*this).contains(XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR));
    PFN_xrVoidFunction function = nullptr;
    EXPECT_EQ(xr.get_proc(xr.instance, "xrLocateSpaces", &function), XR_ERROR_FUNCTION_UNSUPPORTED);
    std::uint32_t count = 0;
    ASSERT_EQ(xr.xrEnumerateViewConfigurations(xr.instance, 1, 0, &count, nullptr), XR_SUCCESS);
    EXPECT_EQ(count, 1u);
    XrSpace space = XR_NULL_HANDLE;
    const XrReferenceSpaceCreateInfo info{XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr, XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR, identity};
    EXPECT_EQ(xr.xrCreateReferenceSpace(session, &info, &space), XR_ERROR_REFERENCE_SPACE_UNSUPPORTED);
}

TEST_F(Version11, LocalFloorIsLocalOnTheFloor) {
    EXPECT_TRUE(reference_spaces(*this).contains(XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR));
    const XrSpace floor = reference_space(XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR), local = reference_space(XR_REFERENCE_SPACE_TYPE_LOCAL);
    const XrSpaceLocation location = locate(floor, local, now());
    EXPECT_NEAR(location.pose.position.x, 0, 1e-6);
    EXPECT_NEAR(location.pose.position.y, -1.2, 1e-6) << "the fake head sits 1.2 m above the floor";
    EXPECT_NEAR(location.pose.orientation.w, 1, 1e-6);
}

TEST_F(Version11, LocateSpacesSaysWhatLocateSpaceSays) {
    const auto locate_spaces = xr.get<PFN_xrLocateSpaces>("xrLocateSpaces");
    const XrSpace view = reference_space(XR_REFERENCE_SPACE_TYPE_VIEW, {{0, 0.6f, 0, 0.8f}, {1, 2, 3}});
    const XrSpace stage = reference_space(XR_REFERENCE_SPACE_TYPE_STAGE), local = reference_space(XR_REFERENCE_SPACE_TYPE_LOCAL);
    const std::array spaces{view, stage};
    std::array<XrSpaceLocationData, 2> data{};
    std::array<XrSpaceVelocityData, 2> velocity_data{};
    XrSpaceVelocities velocities{XR_TYPE_SPACE_VELOCITIES, nullptr, 2, velocity_data.data()};
    XrSpaceLocations locations{XR_TYPE_SPACE_LOCATIONS, &velocities, 2, data.data()};
    XrSpacesLocateInfo info{XR_TYPE_SPACES_LOCATE_INFO, nullptr, local, now(), 2, spaces.data()};
    ASSERT_EQ(locate_spaces(session, &info, &locations), XR_SUCCESS);
    for (std::size_t i = 0; i < 2; ++i) {
        const XrSpaceLocation one = locate(spaces[i], local, info.time);
        EXPECT_EQ(data[i].locationFlags, one.locationFlags);
        EXPECT_EQ(std::memcmp(&data[i].pose, &one.pose, sizeof(XrPosef)), 0);
        EXPECT_EQ(velocity_data[i].velocityFlags, XR_SPACE_VELOCITY_LINEAR_VALID_BIT | XR_SPACE_VELOCITY_ANGULAR_VALID_BIT);
    }
    locations.locationCount = 1;
    EXPECT_EQ(locate_spaces(session, &info, &locations), XR_ERROR_VALIDATION_FAILURE);
    locations.locationCount = 2;
    velocities.velocityCount = 3;
    EXPECT_EQ(locate_spaces(session, &info, &locations), XR_ERROR_VALIDATION_FAILURE);
    velocities.velocityCount = 2;
    info.spaceCount = 0;
    EXPECT_EQ(locate_spaces(session, &info, &locations), XR_ERROR_VALIDATION_FAILURE);
    info.spaceCount = 2;
    info.time = 0;
    EXPECT_EQ(locate_spaces(session, &info, &locations), XR_ERROR_TIME_INVALID);
    info.baseSpace = XR_NULL_HANDLE;
    EXPECT_EQ(locate_spaces(session, &info, &locations), XR_ERROR_HANDLE_INVALID);
}

// Insets lie inside their eyes' views, about the gaze, and a layer of four views reaches the compositor as two.
TEST_F(Version11, FoveatedInset) {
    constexpr auto inset = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO_WITH_FOVEATED_INSET;
    std::uint32_t count = 0;
    std::array<XrViewConfigurationView, 4> sizes;
    sizes.fill({XR_TYPE_VIEW_CONFIGURATION_VIEW});
    ASSERT_EQ(xr.xrEnumerateViewConfigurationViews(xr.instance, 1, inset, 4, &count, sizes.data()), XR_SUCCESS);
    EXPECT_EQ(sizes[0].recommendedImageRectWidth, 128u) << "half the density";
    const float share = 2 * 0.268f / (2 * std::tan(0.9f));
    EXPECT_EQ(sizes[2].recommendedImageRectWidth, std::uint32_t(std::lround(256 * share))) << "all of it";
    const XrSessionBeginInfo begin{XR_TYPE_SESSION_BEGIN_INFO, nullptr, inset};
    ASSERT_EQ(xr.xrBeginSession(session, &begin), XR_SUCCESS);
    const XrSpace view = reference_space(XR_REFERENCE_SPACE_TYPE_VIEW);
    const float yaw = 0.3f;
    for (EyeState& eye : xr.host->eyes.state.eyes) {
        eye.gaze_direction = {std::sin(yaw), 0, -std::cos(yaw)};
        eye.gaze_provenance = Provenance::measured;
    }
    std::array<XrView, 4> views;
    views.fill({XR_TYPE_VIEW});
    XrViewState state{XR_TYPE_VIEW_STATE};
    const XrViewLocateInfo locate_info{XR_TYPE_VIEW_LOCATE_INFO, nullptr, inset, now(), view};
    ASSERT_EQ(xr.xrLocateViews(session, &locate_info, &state, 4, &count, views.data()), XR_SUCCESS);
    for (std::size_t eye = 0; eye < 2; ++eye) {
        EXPECT_EQ(std::memcmp(&views[eye].pose, &views[eye + 2].pose, sizeof(XrPosef)), 0);
        EXPECT_NEAR((std::tan(views[eye + 2].fov.angleLeft) + std::tan(views[eye + 2].fov.angleRight)) / 2, std::tan(yaw), 1e-5);
        EXPECT_LT(views[eye + 2].fov.angleRight, views[eye].fov.angleRight);
    }
    // Beyond the edge the inset stays within the view.
    for (EyeState& eye : xr.host->eyes.state.eyes) eye.gaze_direction = {std::sin(1.2f), 0, -std::cos(1.2f)};
    ASSERT_EQ(xr.xrLocateViews(session, &locate_info, &state, 4, &count, views.data()), XR_SUCCESS);
    EXPECT_NEAR(views[2].fov.angleRight, views[0].fov.angleRight, 1e-6);

    const XrSwapchain swapchain = make_swapchain();
    cycle(swapchain);
    std::array<XrCompositionLayerProjectionView, 4> layer_views;
    for (std::size_t i = 0; i < 4; ++i) {
        layer_views[i] = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, nullptr, identity, views[i].fov, {swapchain, {{0, 0}, {8, 8}}, 0}};
    }
    XrCompositionLayerProjection layer{XR_TYPE_COMPOSITION_LAYER_PROJECTION, nullptr, 0, view, 2, layer_views.data()};
    const auto* base = reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer);
    EXPECT_EQ(frame({base}), XR_ERROR_VALIDATION_FAILURE) << "two views in a session of four";
    layer.viewCount = 4;
    EXPECT_EQ(end_frame(now(), {base}), XR_SUCCESS);
    const auto layers = xr.host->service.last_submission().layers;
    ASSERT_EQ(layers.size(), 2u);
    EXPECT_FALSE(layers[0].replaces_previous);
    EXPECT_TRUE(layers[1].replaces_previous);
    EXPECT_FLOAT_EQ(layers[1].views[0].fov.angle_right, views[2].fov.angleRight);
}

// The meshes tile the view: visible and hidden areas sum to the rectangle, and every triangle turns the right way.
TEST_F(Version11, VisibilityMask) {
    const auto get = xr.get<PFN_xrGetVisibilityMaskKHR>("xrGetVisibilityMaskKHR");
    const auto area = [&](XrVisibilityMaskTypeKHR type) {
        XrVisibilityMaskKHR mask{XR_TYPE_VISIBILITY_MASK_KHR};
        EXPECT_EQ(get(session, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, 1, type, &mask), XR_SUCCESS);
        std::vector<XrVector2f> vertices(mask.vertexCountOutput);
        std::vector<std::uint32_t> indices(mask.indexCountOutput);
        mask.vertexCapacityInput = mask.vertexCountOutput;
        mask.indexCapacityInput = mask.indexCountOutput;
        mask.vertices = vertices.data();
        mask.indices = indices.data();
        EXPECT_EQ(get(session, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, 1, type, &mask), XR_SUCCESS);
        double total = 0;
        for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
            const XrVector2f a = vertices[indices[i]], b = vertices[indices[i + 1]], c = vertices[indices[i + 2]];
            const double twice = double(b.x - a.x) * (c.y - a.y) - double(b.y - a.y) * (c.x - a.x);
            EXPECT_GT(twice, 0);
            total += twice / 2;
        }
        return total;
    };
    // A lens that shows a circle inside the view.
    Lens& lens = xr.host->headset().eyes[1].lens;
    lens.r2_cutoff = 0.5f;
    lens.focal = {1, 1};
    lens.aspect = 1;
    const double whole = std::pow(2 * std::tan(0.9), 2);
    const double visible = area(XR_VISIBILITY_MASK_TYPE_VISIBLE_TRIANGLE_MESH_KHR);
    const double hidden = area(XR_VISIBILITY_MASK_TYPE_HIDDEN_TRIANGLE_MESH_KHR);
    EXPECT_NEAR(visible + hidden, whole, 1e-3);
    EXPECT_NEAR(visible, M_PI * 0.5, 0.02) << "the circle that the lens shows, and its margin";
    EXPECT_GE(visible, M_PI * 0.5) << "nothing seen is cut off";
    XrVisibilityMaskKHR mask{XR_TYPE_VISIBILITY_MASK_KHR};
    EXPECT_EQ(get(session, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, 2, XR_VISIBILITY_MASK_TYPE_LINE_LOOP_KHR, &mask),
              XR_ERROR_VALIDATION_FAILURE);
}

TEST_F(Version11, RefreshRateIsThePanels) {
    float rate = 0;
    ASSERT_EQ(xr.get<PFN_xrGetDisplayRefreshRateFB>("xrGetDisplayRefreshRateFB")(session, &rate), XR_SUCCESS);
    EXPECT_FLOAT_EQ(rate, 90);
    const auto request = xr.get<PFN_xrRequestDisplayRefreshRateFB>("xrRequestDisplayRefreshRateFB");
    EXPECT_EQ(request(session, 0), XR_SUCCESS);
    EXPECT_EQ(request(session, 90), XR_SUCCESS);
    EXPECT_EQ(request(session, 72), XR_ERROR_DISPLAY_REFRESH_RATE_UNSUPPORTED_FB);
    EXPECT_EQ(request(session, NAN), XR_ERROR_DISPLAY_REFRESH_RATE_UNSUPPORTED_FB);
}

struct FakePresence final : PresenceSource {
    bool user_present() override { return worn; }
    bool worn = true;
};

TEST_F(Version11, PresenceIsToldAtBeginAndWhenItChanges) {
    FakePresence presence;
    xr.host->headset().presence = &presence;
    const auto told = [&] {
        std::vector<bool> events;
        XrEventDataBuffer event{XR_TYPE_EVENT_DATA_BUFFER};
        while (xr.xrPollEvent(xr.instance, &event) == XR_SUCCESS) {
            if (event.type == XR_TYPE_EVENT_DATA_USER_PRESENCE_CHANGED_EXT)
                events.push_back(reinterpret_cast<const XrEventDataUserPresenceChangedEXT*>(&event)->isUserPresent);
            event = {XR_TYPE_EVENT_DATA_BUFFER};
        }
        return events;
    };
    EXPECT_EQ(begin_session(), XR_SUCCESS);
    EXPECT_EQ(told(), std::vector<bool>{true});
    frame();
    EXPECT_TRUE(told().empty());
    presence.worn = false;
    frame();
    EXPECT_EQ(told(), std::vector<bool>{false});
    xr.host->headset().presence = nullptr;
}

TEST(Extensions, DependenciesAreAskedFor) {
    const auto get = negotiated();
    PFN_xrVoidFunction create = nullptr;
    ASSERT_EQ(get(XR_NULL_HANDLE, "xrCreateInstance", &create), XR_SUCCESS);
    const char* alone[] = {"XR_EXT_dpad_binding"};
    XrInstanceCreateInfo info{XR_TYPE_INSTANCE_CREATE_INFO};
    std::strcpy(info.applicationInfo.applicationName, "test");
    info.applicationInfo.apiVersion = v1_0;
    info.enabledExtensionCount = 1;
    info.enabledExtensionNames = alone;
    XrInstance instance = XR_NULL_HANDLE;
    EXPECT_EQ(reinterpret_cast<PFN_xrCreateInstance>(create)(&info, &instance), XR_ERROR_EXTENSION_DEPENDENCY_NOT_ENABLED);
}

}  // namespace
}  // namespace entoptic::runtime::testing
