// labels: gpu
// The frame loop, and layers from the application's structures to interfaces/layers.h.
#include "runtime/testing/client.h"

#include "entoptic/XR_ENTOPTICX_scene_luminance.h"

#include <cmath>
#include <limits>

namespace entoptic::runtime::testing {
namespace {

const XrCompositionLayerBaseHeader* header(const void* layer) { return static_cast<const XrCompositionLayerBaseHeader*>(layer); }
constexpr XrPosef identity{{0, 0, 0, 1}, {0, 0, 0}};

class Frames : public SessionTest {
public:
    void SetUp() override {
        SessionTest::SetUp();
        local = reference_space(XR_REFERENCE_SPACE_TYPE_LOCAL);
        view = reference_space(XR_REFERENCE_SPACE_TYPE_VIEW, {{0, 0, 0, 1}, {0, 0, -1}});
        swapchain = make_swapchain(swapchain_info(2));
        empty_swapchain = make_swapchain();
        image = cycle(swapchain);
        run_to_focus();
    }
    XrSwapchainSubImage sub_image(std::uint32_t slice = 0) const { return {swapchain, {{0, 0}, {64, 32}}, slice}; }
    XrCompositionLayerQuad quad() const {
        XrCompositionLayerQuad layer{XR_TYPE_COMPOSITION_LAYER_QUAD, nullptr,     0,        local,
                                     XR_EYE_VISIBILITY_BOTH,         sub_image(), identity, {1, 2}};
        return layer;
    }
    XrResult submit(const XrCompositionLayerQuad& layer) { return frame({header(&layer)}); }

    XrSpace local = XR_NULL_HANDLE, view = XR_NULL_HANDLE;
    XrSwapchain swapchain = XR_NULL_HANDLE, empty_swapchain = XR_NULL_HANDLE;
    std::uint32_t image = 0;
};

TEST_F(Frames, NotRunning) {
    EXPECT_EQ(xr.xrRequestExitSession(session), XR_SUCCESS);
    EXPECT_EQ(xr.xrEndSession(session), XR_SUCCESS);
    XrFrameState state{XR_TYPE_FRAME_STATE};
    EXPECT_EQ(xr.xrWaitFrame(session, nullptr, &state), XR_ERROR_SESSION_NOT_RUNNING);
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_ERROR_SESSION_NOT_RUNNING);
    EXPECT_EQ(end_frame(1), XR_ERROR_SESSION_NOT_RUNNING);
}

TEST_F(Frames, CallOrder) {
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_ERROR_CALL_ORDER_INVALID);
    EXPECT_EQ(end_frame(1), XR_ERROR_CALL_ORDER_INVALID);
    XrFrameState state = wait_frame();
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_SUCCESS);
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_ERROR_CALL_ORDER_INVALID) << "does not discard";
    state = wait_frame();
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_FRAME_DISCARDED);
    EXPECT_EQ(xr.host->service.discarded.size(), 1u);
    EXPECT_EQ(end_frame(0), XR_ERROR_TIME_INVALID);
    state = wait_frame();
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_FRAME_DISCARDED) << "a frame whose end failed is still begun";
    EXPECT_EQ(end_frame(state.predictedDisplayTime), XR_SUCCESS);
    EXPECT_EQ(end_frame(state.predictedDisplayTime), XR_ERROR_CALL_ORDER_INVALID);
    EXPECT_EQ(xr.host->service.last_submission().frame_id, xr.host->service.begun.back());
}

TEST_F(Frames, PipelinedLoop) {
    const XrFrameState first = wait_frame();
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_SUCCESS);
    const XrFrameState second = wait_frame();
    EXPECT_EQ(end_frame(first.predictedDisplayTime), XR_SUCCESS);
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_SUCCESS);
    EXPECT_EQ(end_frame(second.predictedDisplayTime), XR_SUCCESS);
    EXPECT_GT(second.predictedDisplayTime, first.predictedDisplayTime);
    EXPECT_EQ(xr.host->service.last_submission().display_time, second.predictedDisplayTime);
}

TEST_F(Frames, StructureTypes) {
    XrFrameState state{XR_TYPE_UNKNOWN};
    EXPECT_EQ(xr.xrWaitFrame(session, nullptr, &state), XR_ERROR_VALIDATION_FAILURE);
    const XrFrameWaitInfo wait{XR_TYPE_ACTIONS_SYNC_INFO};
    state.type = XR_TYPE_FRAME_STATE;
    EXPECT_EQ(xr.xrWaitFrame(session, &wait, &state), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrWaitFrame(session, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    state = wait_frame();
    const XrFrameBeginInfo begin{XR_TYPE_ACTIONS_SYNC_INFO};
    EXPECT_EQ(xr.xrBeginFrame(session, &begin), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_SUCCESS);
    XrFrameEndInfo end{XR_TYPE_ACTIONS_SYNC_INFO, nullptr, state.predictedDisplayTime, XR_ENVIRONMENT_BLEND_MODE_OPAQUE, 0, nullptr};
    EXPECT_EQ(xr.xrEndFrame(session, &end), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrEndFrame(session, nullptr), XR_ERROR_VALIDATION_FAILURE);
    end.type = XR_TYPE_FRAME_END_INFO;
    end.environmentBlendMode = XR_ENVIRONMENT_BLEND_MODE_ADDITIVE;
    EXPECT_EQ(xr.xrEndFrame(session, &end), XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED);
    end.environmentBlendMode = XrEnvironmentBlendMode(0);
    EXPECT_EQ(xr.xrEndFrame(session, &end), XR_ERROR_VALIDATION_FAILURE);
    end.environmentBlendMode = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
    EXPECT_EQ(xr.xrEndFrame(session, &end), XR_SUCCESS) << "no layers: black";
}

TEST_F(Frames, Quad) {
    XrCompositionLayerQuad layer = quad();
    layer.layerFlags = XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT | XR_COMPOSITION_LAYER_UNPREMULTIPLIED_ALPHA_BIT;
    layer.eyeVisibility = XR_EYE_VISIBILITY_RIGHT;
    layer.subImage.imageRect = {{8, 4}, {16, 8}};
    layer.subImage.imageArrayIndex = 1;
    ASSERT_EQ(submit(layer), XR_SUCCESS);
    const FrameSubmission submission = xr.host->service.last_submission();
    ASSERT_EQ(submission.layers.size(), 1u);
    const Layer& found = submission.layers[0];
    EXPECT_EQ(found.kind, LayerKind::quad);
    EXPECT_EQ(found.visibility, EyeVisibility::right);
    EXPECT_TRUE(found.blend_texture_source_alpha);
    EXPECT_TRUE(found.unpremultiplied_alpha);
    EXPECT_FALSE(found.head_locked);
    EXPECT_FLOAT_EQ(found.quad_width_m, 1);
    EXPECT_FLOAT_EQ(found.quad_height_m, 2);
    EXPECT_EQ(found.views[0].image.image_index, image);
    EXPECT_EQ(found.views[0].image.array_layer, 1u);
    EXPECT_EQ(found.views[0].image.x, 8);
    EXPECT_EQ(found.views[0].image.height, 8);
    EXPECT_FLOAT_EQ(found.luminance.cd_per_unit, xr.host->luminance.cd_per_unit);
}

TEST_F(Frames, LayersInViewAreHeadLocked) {
    XrCompositionLayerQuad layer = quad();
    layer.space = view;
    ASSERT_EQ(submit(layer), XR_SUCCESS);
    const Layer found = xr.host->service.last_submission().layers.at(0);
    EXPECT_TRUE(found.head_locked);
    EXPECT_FLOAT_EQ(found.anchor.position.z, -1);
}

TEST_F(Frames, Projection) {
    std::array<XrCompositionLayerProjectionView, 2> views;
    for (std::uint32_t eye = 0; eye < 2; ++eye) {
        views[eye] = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW,
                      nullptr,
                      {{0, 0, 0, 1}, {float(eye), 0, 0}},
                      {-0.5f, 0.6f, 0.7f, -0.8f},
                      sub_image(eye)};
    }
    XrCompositionLayerProjection layer{XR_TYPE_COMPOSITION_LAYER_PROJECTION, nullptr, 0, local, 2, views.data()};
    ASSERT_EQ(frame({header(&layer)}), XR_SUCCESS);
    const Layer found = xr.host->service.last_submission().layers.at(0);
    EXPECT_EQ(found.kind, LayerKind::projection);
    EXPECT_FLOAT_EQ(found.views[1].space_from_view.position.x, 1);
    EXPECT_FLOAT_EQ(found.views[1].fov.angle_right, 0.6f);
    EXPECT_EQ(found.views[1].image.array_layer, 1u);

    layer.viewCount = 1;
    EXPECT_EQ(frame({header(&layer)}), XR_ERROR_VALIDATION_FAILURE);
    layer.viewCount = 2;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        const auto good = views[eye];
        views[eye].pose.orientation = {0.1f, 0.1f, 0.1f, 0.1f};
        EXPECT_EQ(frame({header(&layer)}), XR_ERROR_POSE_INVALID);
        views[eye] = good;
        views[eye].subImage.swapchain = empty_swapchain;
        views[eye].subImage.imageArrayIndex = 0;
        EXPECT_EQ(frame({header(&layer)}), XR_ERROR_LAYER_INVALID);
        views[eye] = good;
        views[eye].fov.angleLeft = std::numeric_limits<float>::quiet_NaN();
        EXPECT_EQ(frame({header(&layer)}), XR_ERROR_VALIDATION_FAILURE);
        views[eye] = good;
        views[eye].type = XR_TYPE_UNKNOWN;
        EXPECT_EQ(frame({header(&layer)}), XR_ERROR_VALIDATION_FAILURE);
        views[eye] = good;
    }
    views[0].fov = {0.5f, 0.5f, 0.5f, -0.5f};
    EXPECT_EQ(frame({header(&layer)}), XR_SUCCESS);
    EXPECT_EQ(xr.host->service.last_submission().layers.at(0).views[0].image.width, 0) << "a view without extent shows nothing";
}

TEST_F(Frames, DepthOfAProjection) {
    XrSwapchainCreateInfo info = swapchain_info(2);
    info.format = VK_FORMAT_D32_SFLOAT;
    info.usageFlags = XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    const XrSwapchain depth_swapchain = make_swapchain(info), unused_depth = make_swapchain(info);
    const std::uint32_t depth_image = cycle(depth_swapchain);
    constexpr float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    std::array<XrCompositionLayerDepthInfoKHR, 2> depths;
    std::array<XrCompositionLayerProjectionView, 2> views;
    for (std::uint32_t eye = 0; eye < 2; ++eye) {
        depths[eye] = {XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR, nullptr, {depth_swapchain, {{4, 2}, {32, 16}}, eye}, 0.25f, 1, infinity, 0.1f};
        views[eye] = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, &depths[eye], identity, {-0.5f, 0.6f, 0.7f, -0.8f}, sub_image(eye)};
    }
    const XrCompositionLayerProjection layer{XR_TYPE_COMPOSITION_LAYER_PROJECTION, nullptr, 0, local, 2, views.data()};
    ASSERT_EQ(frame({header(&layer)}), XR_SUCCESS);
    const LayerDepth found = xr.host->service.last_submission().layers.at(0).views[1].depth;
    EXPECT_EQ(found.image.image_index, depth_image);
    EXPECT_EQ(found.image.array_layer, 1u);
    EXPECT_EQ(found.image.x, 4);
    EXPECT_EQ(found.image.width, 32);
    EXPECT_EQ(found.min_depth, 0.25f);
    EXPECT_EQ(found.max_depth, 1);
    EXPECT_EQ(found.near_z_m, infinity);
    EXPECT_EQ(found.far_z_m, 0.1f);

    const auto with = [&](auto edit) {
        const auto good = depths[1];
        edit(depths[1]);
        const XrResult result = frame({header(&layer)});
        depths[1] = good;
        return result;
    };
    using Depth = XrCompositionLayerDepthInfoKHR;
    EXPECT_EQ(with([](Depth& d) { d.minDepth = -0.1f; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(with([](Depth& d) { d.maxDepth = 1.1f; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(with([](Depth& d) { d.minDepth = d.maxDepth; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(with([](Depth& d) { d.maxDepth = nan; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(with([](Depth& d) { d.nearZ = 0; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(with([](Depth& d) { d.farZ = -1; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(with([](Depth& d) { d.farZ = d.nearZ; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(with([](Depth& d) { d.nearZ = nan; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(with([](Depth& d) { d.nearZ = 0.1f, d.farZ = infinity; }), XR_SUCCESS);
    EXPECT_EQ(with([](Depth& d) { d.subImage.imageRect.extent.width = 100; }), XR_ERROR_SWAPCHAIN_RECT_INVALID);
    EXPECT_EQ(with([](Depth& d) { d.subImage.imageArrayIndex = 2; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(with([](Depth& d) { d.subImage.swapchain = XR_NULL_HANDLE; }), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(with([&](Depth& d) { d.subImage.swapchain = swapchain; }), XR_ERROR_LAYER_INVALID) << "colour is no depth";
    EXPECT_EQ(with([&](Depth& d) { d.subImage.swapchain = unused_depth; }), XR_ERROR_LAYER_INVALID) << "nothing was released";
    views[0].subImage.swapchain = depth_swapchain;
    EXPECT_EQ(frame({header(&layer)}), XR_ERROR_LAYER_INVALID) << "depth is no colour";
    views[0].subImage.swapchain = swapchain;
    views[0].next = nullptr;
    ASSERT_EQ(frame({header(&layer)}), XR_SUCCESS) << "one view may go without";
    EXPECT_EQ(xr.host->service.last_submission().layers.at(0).views[0].depth.image.width, 0);
}

TEST_F(Frames, BadLayers) {
    EXPECT_EQ(frame({nullptr}), XR_ERROR_LAYER_INVALID);
    XrCompositionLayerQuad layer = quad();
    layer.type = XR_TYPE_COMPOSITION_LAYER_CUBE_KHR;
    EXPECT_EQ(submit(layer), XR_ERROR_LAYER_INVALID);
    const auto with = [&](auto edit) {
        XrCompositionLayerQuad changed = quad();
        edit(changed);
        return submit(changed);
    };
    using Quad = XrCompositionLayerQuad;
    EXPECT_EQ(with([](Quad& q) { q.layerFlags = 0x100; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(with([](Quad& q) { q.space = XR_NULL_HANDLE; }), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(with([](Quad& q) { q.subImage.swapchain = XR_NULL_HANDLE; }), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(with([&](Quad& q) { q.subImage.swapchain = empty_swapchain; }), XR_ERROR_LAYER_INVALID);
    EXPECT_EQ(with([](Quad& q) { q.subImage.imageArrayIndex = 2; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(with([](Quad& q) { q.subImage.imageRect.offset = {-1, -1}; }), XR_ERROR_SWAPCHAIN_RECT_INVALID);
    EXPECT_EQ(with([](Quad& q) { q.subImage.imageRect.offset = {1, 1}; }), XR_ERROR_SWAPCHAIN_RECT_INVALID);
    EXPECT_EQ(with([](Quad& q) { q.subImage.imageRect.extent = {-1, 1}; }), XR_ERROR_SWAPCHAIN_RECT_INVALID);
    EXPECT_EQ(with([](Quad& q) { q.subImage.imageRect = {{INT32_MAX, 0}, {INT32_MAX, 1}}; }), XR_ERROR_SWAPCHAIN_RECT_INVALID);
    EXPECT_EQ(with([](Quad& q) { q.pose.orientation = {0, 0, 0, 0.98f}; }), XR_ERROR_POSE_INVALID);
    EXPECT_EQ(with([](Quad& q) { q.pose.position.x = std::numeric_limits<float>::infinity(); }), XR_ERROR_POSE_INVALID);
    EXPECT_EQ(with([](Quad& q) { q.size.width = std::numeric_limits<float>::quiet_NaN(); }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(with([](Quad& q) { q.eyeVisibility = XrEyeVisibility(9); }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(with([](Quad& q) { q.size = {0, 0}; }), XR_SUCCESS);
    EXPECT_EQ(with([](Quad& q) { q.subImage.imageRect.extent = {0, 0}; }), XR_SUCCESS);
}

TEST_F(Frames, LayerCount) {
    const XrCompositionLayerQuad layer = quad();
    EXPECT_EQ(frame(std::vector<const XrCompositionLayerBaseHeader*>(max_layers, header(&layer))), XR_SUCCESS);
    EXPECT_EQ(xr.host->service.last_submission().layers.size(), max_layers);
    EXPECT_EQ(frame(std::vector<const XrCompositionLayerBaseHeader*>(max_layers + 1, header(&layer))), XR_ERROR_LAYER_LIMIT_EXCEEDED);
    const XrFrameState state = wait_frame();
    EXPECT_TRUE(XR_SUCCEEDED(xr.xrBeginFrame(session, nullptr)));
    XrFrameEndInfo end{XR_TYPE_FRAME_END_INFO, nullptr, state.predictedDisplayTime, XR_ENVIRONMENT_BLEND_MODE_OPAQUE, 3, nullptr};
    EXPECT_EQ(xr.xrEndFrame(session, &end), XR_ERROR_VALIDATION_FAILURE);
    end.layerCount = 0xffffffff;
    EXPECT_EQ(xr.xrEndFrame(session, &end), XR_ERROR_LAYER_LIMIT_EXCEEDED);
}

TEST_F(Frames, LuminanceOfALayer) {
    XrBaseInStructure unknown{XrStructureType(55555), nullptr};
    XrCompositionLayerSceneLuminanceENTOPTICX luminance{XR_TYPE_COMPOSITION_LAYER_SCENE_LUMINANCE_ENTOPTICX, nullptr, 0.25f};
    unknown.next = reinterpret_cast<const XrBaseInStructure*>(&luminance);
    XrCompositionLayerQuad layer = quad();
    layer.next = &unknown;
    ASSERT_EQ(submit(layer), XR_SUCCESS);
    const LayerLuminance found = xr.host->service.last_submission().layers.at(0).luminance;
    EXPECT_FLOAT_EQ(found.cd_per_unit, 0.25f);
    EXPECT_FLOAT_EQ(found.offset_cd, 0);
    EXPECT_EQ(found.source, LuminanceSource::layer_extension);
    for (const float bad : {0.0f, -1.0f, 1e7f, 1e-7f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
        luminance.luminancePerUnit = bad;
        EXPECT_EQ(submit(layer), XR_ERROR_VALIDATION_FAILURE) << bad;
    }
}

TEST_F(Frames, DestroyedSwapchainIsNotShown) {
    const XrCompositionLayerQuad layer = quad();
    ASSERT_EQ(submit(layer), XR_SUCCESS);
    EXPECT_EQ(xr.xrDestroySwapchain(swapchain), XR_SUCCESS);
    EXPECT_EQ(xr.host->service.living_swapchains(), 1u);
    EXPECT_EQ(submit(layer), XR_ERROR_HANDLE_INVALID);
}

}  // namespace
}  // namespace entoptic::runtime::testing
