// labels: gpu
// Composition layers of the KHR extensions: what of them reaches the compositor, and what is refused.
#include "runtime/testing/client.h"

#include <cmath>
#include <limits>

namespace entoptic::runtime::testing {
namespace {

constexpr XrPosef identity{{0, 0, 0, 1}, {0, 0, 0}};
constexpr float pi = 3.14159265f;

class Layers : public SessionTest {
public:
    Layers()
        : SessionTest({"XR_KHR_vulkan_enable2", "XR_KHR_composition_layer_cylinder", "XR_KHR_composition_layer_equirect",
                       "XR_KHR_composition_layer_equirect2", "XR_KHR_composition_layer_cube", "XR_KHR_composition_layer_color_scale_bias"},
                      XR_MAKE_VERSION(1, 0, 0)) {}
    void SetUp() override {
        SessionTest::SetUp();
        run_to_focus();
        space = reference_space(XR_REFERENCE_SPACE_TYPE_STAGE);
        swapchain = make_swapchain();
        cycle(swapchain);
    }
    template <class L> XrResult show(const L& layer) { return frame({reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer)}); }
    // Ends the frame that a refused layer left begun.
    void drop() { EXPECT_EQ(end_frame(now()), XR_SUCCESS); }
    std::vector<Layer> shown() { return xr.host->service.last_submission().layers; }

    XrSpace space = XR_NULL_HANDLE;
    XrSwapchain swapchain = XR_NULL_HANDLE;
    XrCompositionLayerCylinderKHR cylinder() {
        return {XR_TYPE_COMPOSITION_LAYER_CYLINDER_KHR, nullptr,  0, space, XR_EYE_VISIBILITY_BOTH,
                {swapchain, {{0, 0}, {64, 32}}, 0},     identity, 2, 1.5f,  3};
    }
};

TEST_F(Layers, Cylinder) {
    auto layer = cylinder();
    ASSERT_EQ(show(layer), XR_SUCCESS);
    ASSERT_EQ(shown().size(), 1u);
    EXPECT_EQ(shown()[0].kind, LayerKind::cylinder);
    EXPECT_FLOAT_EQ(shown()[0].surface.height_m, 2 * 1.5f / 3) << "arc length over aspect ratio";
    for (const float angle : {-0.1f, 2 * pi, NAN}) {
        layer.centralAngle = angle;
        EXPECT_EQ(show(layer), XR_ERROR_VALIDATION_FAILURE) << angle;
        drop();
    }
    layer = cylinder();
    layer.aspectRatio = 0;
    EXPECT_EQ(show(layer), XR_ERROR_VALIDATION_FAILURE);
    drop();
    layer = cylinder();
    layer.radius = -1;
    EXPECT_EQ(show(layer), XR_ERROR_VALIDATION_FAILURE);
    drop();
    layer = cylinder();
    layer.subImage.imageRect.extent.width = 65;
    EXPECT_EQ(show(layer), XR_ERROR_SWAPCHAIN_RECT_INVALID);
    drop();
}

// The whole sphere both ways: scale 1 and bias 0 are the angles 2 pi, pi/2 and -pi/2.
TEST_F(Layers, EquirectOfBothKindsAgree) {
    const XrCompositionLayerEquirectKHR first{XR_TYPE_COMPOSITION_LAYER_EQUIRECT_KHR, nullptr,  0, space,  XR_EYE_VISIBILITY_BOTH,
                                              {swapchain, {{0, 0}, {64, 32}}, 0},     identity, 0, {2, 2}, {-0.5f, -0.5f}};
    const XrCompositionLayerEquirect2KHR second{XR_TYPE_COMPOSITION_LAYER_EQUIRECT2_KHR,
                                                nullptr,
                                                0,
                                                space,
                                                XR_EYE_VISIBILITY_BOTH,
                                                {swapchain, {{0, 0}, {64, 32}}, 0},
                                                identity,
                                                0,
                                                pi,
                                                pi / 4,
                                                -pi / 4};
    ASSERT_EQ(show(first), XR_SUCCESS);
    const Layer a = shown().at(0);
    ASSERT_EQ(show(second), XR_SUCCESS);
    const Layer b = shown().at(0);
    EXPECT_NEAR(a.surface.longitude_extent, b.surface.longitude_extent, 1e-5);
    EXPECT_NEAR(a.surface.longitude_centre, b.surface.longitude_centre, 1e-5);
    EXPECT_NEAR(a.surface.latitude_top, b.surface.latitude_top, 1e-5);
    EXPECT_NEAR(a.surface.latitude_bottom, b.surface.latitude_bottom, 1e-5);
}

// Directions of the texels of a cube map: the table of the OpenGL and Vulkan specifications (major axis, s, t).
TEST_F(Layers, CubeFacesFollowTheTable) {
    XrSwapchainCreateInfo info = swapchain_info();
    info.width = info.height = 16;
    info.faceCount = 6;
    const XrSwapchain cube = make_swapchain(info);
    cycle(cube);
    const XrCompositionLayerCubeKHR layer{
        XR_TYPE_COMPOSITION_LAYER_CUBE_KHR, nullptr, 0, space, XR_EYE_VISIBILITY_BOTH, cube, 0, {0, 0, 0, 1}};
    ASSERT_EQ(show(layer), XR_SUCCESS);
    ASSERT_EQ(shown().size(), 6u);
    const auto direction = [](std::uint32_t face, float s, float t) -> glm::vec3 {
        switch (face) {
            case 0:
                return {1, -t, -s};
            case 1:
                return {-1, -t, s};
            case 2:
                return {s, 1, t};
            case 3:
                return {s, -1, -t};
            case 4:
                return {s, -t, 1};
            default:
                return {-s, -t, -1};
        }
    };
    for (const Layer& face : shown()) {
        const LayerView& view = face.views[0];
        for (const auto& [s, t] : {std::pair(0.0f, 0.0f), {0.6f, 0.0f}, {0.0f, 0.6f}, {-0.5f, 0.9f}}) {
            // The texel's place in the view that the compositor turns: left edge at s = -1, top at t = -1.
            const float x = std::tan(view.fov.angle_left) + (std::tan(view.fov.angle_right) - std::tan(view.fov.angle_left)) * (s + 1) / 2;
            const float y = std::tan(view.fov.angle_up) + (std::tan(view.fov.angle_down) - std::tan(view.fov.angle_up)) * (t + 1) / 2;
            const glm::vec3 seen = view.space_from_view.rotate({x, y, -1});
            EXPECT_LT(glm::distance(seen, direction(view.image.array_layer, s, t)), 1e-5f) << view.image.array_layer;
        }
    }
    auto quad = XrCompositionLayerQuad{XR_TYPE_COMPOSITION_LAYER_QUAD, nullptr,  0,     space, XR_EYE_VISIBILITY_BOTH,
                                       {cube, {{0, 0}, {16, 16}}, 0},  identity, {1, 1}};
    EXPECT_EQ(show(quad), XR_ERROR_VALIDATION_FAILURE) << "a cube on a quad";
    drop();
    auto flat = layer;
    flat.swapchain = swapchain;
    EXPECT_EQ(show(flat), XR_ERROR_VALIDATION_FAILURE) << "a flat swapchain on a cube";
    drop();
}

TEST_F(Layers, ColourScaleAndBias) {
    XrCompositionLayerColorScaleBiasKHR tint{XR_TYPE_COMPOSITION_LAYER_COLOR_SCALE_BIAS_KHR, nullptr, {1, 2, 3, 4}, {5, 6, 7, 8}};
    auto layer = cylinder();
    layer.next = &tint;
    ASSERT_EQ(show(layer), XR_SUCCESS);
    EXPECT_FLOAT_EQ(shown()[0].tint.scale[2], 3);
    EXPECT_FLOAT_EQ(shown()[0].tint.bias[3], 8);
    tint.colorBias.g = std::numeric_limits<float>::infinity();
    EXPECT_EQ(show(layer), XR_ERROR_VALIDATION_FAILURE);
    drop();
}

TEST(LayersWithoutExtensions, AreRefused) {
    struct Plain : SessionTest {
        Plain() : SessionTest({"XR_KHR_vulkan_enable2"}, XR_MAKE_VERSION(1, 0, 0)) {}
        void TestBody() override {}
    } test;
    test.SetUp();
    test.run_to_focus();
    const XrCompositionLayerCubeKHR layer{XR_TYPE_COMPOSITION_LAYER_CUBE_KHR};
    EXPECT_EQ(test.frame({reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer)}), XR_ERROR_LAYER_INVALID);
    test.TearDown();
}

}  // namespace
}  // namespace entoptic::runtime::testing
