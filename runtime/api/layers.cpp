#include "runtime/api/layers.h"

#include "entoptic/XR_ENTOPTICX_scene_luminance.h"
#include "runtime/api/layer_parts.h"
#include "runtime/api/verify.h"
#include "runtime/objects/session.h"
#include "runtime/objects/space.h"
#include "runtime/objects/swapchain.h"
#include "runtime/objects/views.h"

#include <algorithm>
#include <cmath>

namespace entoptic::runtime::api {

namespace {

constexpr XrCompositionLayerFlags known_layer_flags = XR_COMPOSITION_LAYER_CORRECT_CHROMATIC_ABERRATION_BIT |
                                                      XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT |
                                                      XR_COMPOSITION_LAYER_UNPREMULTIPLIED_ALPHA_BIT;

Outcome resolve_luminance(const LayerContext& context, const void* chain, LayerLuminance& luminance) {
    luminance = context.default_luminance;
    if (!context.session->instance().enabled(XR_ENTOPTICX_SCENE_LUMINANCE_EXTENSION_NAME)) return XR_SUCCESS;
    const auto* scale = chained<XrCompositionLayerSceneLuminanceENTOPTICX>(chain, XR_TYPE_COMPOSITION_LAYER_SCENE_LUMINANCE_ENTOPTICX);
    if (!scale) return XR_SUCCESS;
    const float value = scale->luminancePerUnit;
    if (!(value >= XR_ENTOPTICX_SCENE_LUMINANCE_MIN && value <= XR_ENTOPTICX_SCENE_LUMINANCE_MAX)) {  // also for NaN
        return invalid("luminancePerUnit is {} cd/m²; it must lie within {} and {}", value, XR_ENTOPTICX_SCENE_LUMINANCE_MIN,
                       XR_ENTOPTICX_SCENE_LUMINANCE_MAX);
    }
    luminance = {value, 0.0f, LuminanceSource::layer_extension};
    return XR_SUCCESS;
}

// `shown` is false when the space cannot be located.
Outcome resolve_space(const LayerContext& context, XrSpace handle, Layer& layer, bool& shown) {
    std::shared_ptr<Space> space;
    ENTOPTIC_XR_TRY(find(handle, space));
    if (space->session() != context.session) return invalid("the layer's space belongs to another session");
    layer.head_locked = space->is_view();
    if (layer.head_locked) {
        layer.anchor = space->root_from_space();
        shown = true;
        return XR_SUCCESS;
    }
    const PoseState state = space->world_from_space(context.time);
    layer.anchor = state.pose;
    shown = state.orientation_valid && state.position_valid;
    return XR_SUCCESS;
}

Outcome resolve_fov(const XrFovf& given, LayerView& view) {
    for (const float angle : {given.angleLeft, given.angleRight, given.angleUp, given.angleDown}) {
        if (!(std::abs(angle) < 1.5707964f)) return invalid("a field of view angle is {} rad; it must lie between -π/2 and π/2", angle);
    }
    view.fov = {given.angleLeft, given.angleRight, given.angleUp, given.angleDown};
    // A view without extent shows nothing; an empty image says so without a division by zero.
    if (given.angleLeft == given.angleRight || given.angleUp == given.angleDown) view.image.width = view.image.height = 0;
    return XR_SUCCESS;
}

// XR_KHR_composition_layer_depth, "Member Descriptions" of XrCompositionLayerDepthInfoKHR. Written so that NaN fails.
Outcome resolve_depth(const LayerContext& context, const void* chain, LayerDepth& depth) {
    if (!context.session->instance().enabled(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME)) return XR_SUCCESS;
    const auto* given = chained<XrCompositionLayerDepthInfoKHR>(chain, XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR);
    if (!given) return XR_SUCCESS;
    if (!(given->minDepth >= 0 && given->maxDepth <= 1 && given->minDepth < given->maxDepth)) {
        return invalid("minDepth {} must be less than maxDepth {}, both within 0 and 1", given->minDepth, given->maxDepth);
    }
    if (!(given->nearZ > 0 && given->farZ > 0 && given->nearZ != given->farZ)) {
        return invalid("nearZ {} and farZ {} must be positive distances in metres and differ", given->nearZ, given->farZ);
    }
    ENTOPTIC_XR_TRY(resolve_sub_image(context, given->subImage, Holds::depth, depth.image));
    depth.min_depth = given->minDepth;
    depth.max_depth = given->maxDepth;
    depth.near_z_m = given->nearZ;
    depth.far_z_m = given->farZ;
    return XR_SUCCESS;
}

// Both eyes' views from `first_view` on.
Outcome resolve_projection(const LayerContext& context, const XrCompositionLayerProjection& given, std::size_t first_view, Layer& layer) {
    layer.kind = LayerKind::projection;
    for (std::size_t eye = 0; eye < eye_count; ++eye) {
        const XrCompositionLayerProjectionView& view = given.views[first_view + eye];
        ENTOPTIC_XR_TRY(require(&view, XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, "a projection view"));
        ENTOPTIC_XR_TRY(check_pose(view.pose));
        ENTOPTIC_XR_TRY(resolve_sub_image(context, view.subImage, Holds::colour, layer.views[eye].image));
        ENTOPTIC_XR_TRY(resolve_depth(context, view.next, layer.views[eye].depth));
        ENTOPTIC_XR_TRY(resolve_fov(view.fov, layer.views[eye]));
        layer.views[eye].space_from_view = to_pose(view.pose);
    }
    return XR_SUCCESS;
}

Outcome resolve_quad(const LayerContext& context, const XrCompositionLayerQuad& given, Layer& layer) {
    layer.kind = LayerKind::quad;
    ENTOPTIC_XR_TRY(resolve_visibility(given.eyeVisibility, layer));
    ENTOPTIC_XR_TRY(check_pose(given.pose));
    if (!std::isfinite(given.size.width) || !std::isfinite(given.size.height) || given.size.width < 0 || given.size.height < 0) {
        return invalid("the quad's size {} x {} m must be finite and not negative", given.size.width, given.size.height);
    }
    ENTOPTIC_XR_TRY(resolve_sub_image(context, given.subImage, Holds::colour, layer.views[0].image));
    layer.views[1].image = layer.views[0].image;
    layer.space_from_quad = to_pose(given.pose);
    layer.quad_width_m = given.size.width;
    layer.quad_height_m = given.size.height;
    return XR_SUCCESS;
}

Outcome check_views(const LayerContext& context, const XrCompositionLayerProjection& given) {
    const std::size_t wanted = view_count(context.session->view_configuration());
    if (given.viewCount != wanted) {
        return invalid("the projection layer has {} views; the session's view configuration has {}", given.viewCount, wanted);
    }
    return require_pointer(given.views, "the projection layer's views");
}

// XR_ERROR_LAYER_INVALID unless this type of layer is core or of an enabled extension.
Outcome check_offered(const Instance& instance, XrStructureType type) {
    struct Type {
        XrStructureType type;
        const char* extension;
    };
    constexpr Type types[] = {{XR_TYPE_COMPOSITION_LAYER_PROJECTION, nullptr},
                              {XR_TYPE_COMPOSITION_LAYER_QUAD, nullptr},
                              {XR_TYPE_COMPOSITION_LAYER_CYLINDER_KHR, XR_KHR_COMPOSITION_LAYER_CYLINDER_EXTENSION_NAME},
                              {XR_TYPE_COMPOSITION_LAYER_EQUIRECT_KHR, XR_KHR_COMPOSITION_LAYER_EQUIRECT_EXTENSION_NAME},
                              {XR_TYPE_COMPOSITION_LAYER_EQUIRECT2_KHR, XR_KHR_COMPOSITION_LAYER_EQUIRECT2_EXTENSION_NAME},
                              {XR_TYPE_COMPOSITION_LAYER_CUBE_KHR, XR_KHR_COMPOSITION_LAYER_CUBE_EXTENSION_NAME}};
    for (const Type& known : types) {
        if (known.type == type && (!known.extension || instance.enabled(known.extension))) return XR_SUCCESS;
    }
    return error(XR_ERROR_LAYER_INVALID, "layer type {} is not one of this version of OpenXR or of an enabled extension",
                 static_cast<int>(type));
}

Outcome resolve_tint(const LayerContext& context, const void* chain, LayerTint& tint) {
    if (!context.session->instance().enabled(XR_KHR_COMPOSITION_LAYER_COLOR_SCALE_BIAS_EXTENSION_NAME)) return XR_SUCCESS;
    const auto* given = chained<XrCompositionLayerColorScaleBiasKHR>(chain, XR_TYPE_COMPOSITION_LAYER_COLOR_SCALE_BIAS_KHR);
    if (!given) return XR_SUCCESS;
    tint.scale = {given->colorScale.r, given->colorScale.g, given->colorScale.b, given->colorScale.a};
    tint.bias = {given->colorBias.r, given->colorBias.g, given->colorBias.b, given->colorBias.a};
    const auto finite = [](float value) { return std::isfinite(value); };
    if (std::all_of(tint.scale.begin(), tint.scale.end(), finite) && std::all_of(tint.bias.begin(), tint.bias.end(), finite))
        return XR_SUCCESS;
    return invalid("colorScale and colorBias must be finite");
}

// What all layers have.
Outcome resolve_base(const LayerContext& context, const XrCompositionLayerBaseHeader& given, Layer& layer, bool& shown) {
    if ((given.layerFlags & ~known_layer_flags) != 0) return invalid("layerFlags has unknown bits ({:#x})", given.layerFlags);
    layer.blend_texture_source_alpha = (given.layerFlags & XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT) != 0;
    layer.unpremultiplied_alpha = (given.layerFlags & XR_COMPOSITION_LAYER_UNPREMULTIPLIED_ALPHA_BIT) != 0;
    ENTOPTIC_XR_TRY(resolve_luminance(context, given.next, layer.luminance));
    ENTOPTIC_XR_TRY(resolve_tint(context, given.next, layer.tint));
    return resolve_space(context, given.space, layer, shown);
}

// Appends what the compositor shows of one layer of the application: nothing, itself, or its parts.
Outcome resolve_layer(const LayerContext& context, const XrCompositionLayerBaseHeader* given, std::vector<Layer>& layers) {
    if (!given) return error(XR_ERROR_LAYER_INVALID, "a layer is null");
    ENTOPTIC_XR_TRY(check_offered(context.session->instance(), given->type));
    const auto* projection = reinterpret_cast<const XrCompositionLayerProjection*>(given);
    Layer layer;
    bool shown = false;
    switch (given->type) {
        case XR_TYPE_COMPOSITION_LAYER_PROJECTION:
            ENTOPTIC_XR_TRY(check_views(context, *projection));
            ENTOPTIC_XR_TRY(resolve_base(context, *given, layer, shown));
            ENTOPTIC_XR_TRY(resolve_projection(context, *projection, 0, layer));
            break;
        case XR_TYPE_COMPOSITION_LAYER_QUAD:
            ENTOPTIC_XR_TRY(resolve_base(context, *given, layer, shown));
            ENTOPTIC_XR_TRY(resolve_quad(context, *reinterpret_cast<const XrCompositionLayerQuad*>(given), layer));
            break;
        case XR_TYPE_COMPOSITION_LAYER_CYLINDER_KHR:
            ENTOPTIC_XR_TRY(resolve_base(context, *given, layer, shown));
            ENTOPTIC_XR_TRY(resolve_cylinder(context, *reinterpret_cast<const XrCompositionLayerCylinderKHR*>(given), layer));
            break;
        case XR_TYPE_COMPOSITION_LAYER_EQUIRECT_KHR:
            ENTOPTIC_XR_TRY(resolve_base(context, *given, layer, shown));
            ENTOPTIC_XR_TRY(resolve_equirect(context, *reinterpret_cast<const XrCompositionLayerEquirectKHR*>(given), layer));
            break;
        case XR_TYPE_COMPOSITION_LAYER_EQUIRECT2_KHR:
            ENTOPTIC_XR_TRY(resolve_base(context, *given, layer, shown));
            ENTOPTIC_XR_TRY(resolve_equirect2(context, *reinterpret_cast<const XrCompositionLayerEquirect2KHR*>(given), layer));
            break;
        case XR_TYPE_COMPOSITION_LAYER_CUBE_KHR:
            ENTOPTIC_XR_TRY(resolve_base(context, *given, layer, shown));
            return resolve_cube(context, *reinterpret_cast<const XrCompositionLayerCubeKHR*>(given), layer, shown, layers);
        default:
            break;  // not offered: refused above
    }
    if (shown) layers.push_back(layer);
    if (given->type != XR_TYPE_COMPOSITION_LAYER_PROJECTION || projection->viewCount == eye_count) return XR_SUCCESS;
    Layer inset = layer;
    inset.replaces_previous = true;
    ENTOPTIC_XR_TRY(resolve_projection(context, *projection, eye_count, inset));
    if (shown) layers.push_back(inset);
    return XR_SUCCESS;
}

}  // namespace

Outcome resolve_layers(const std::shared_ptr<Session>& session, const XrFrameEndInfo& info, std::vector<Layer>& layers) {
    if (info.layerCount > max_layers) {
        return error(XR_ERROR_LAYER_LIMIT_EXCEEDED, "{} layers are more than the {} of this system", info.layerCount, max_layers);
    }
    if (info.layerCount > 0) ENTOPTIC_XR_TRY(require_pointer(info.layers, "frameEndInfo->layers"));
    const LayerContext context{session, info.displayTime, session->host().default_luminance()};
    for (std::uint32_t i = 0; i < info.layerCount; ++i) { ENTOPTIC_XR_TRY(resolve_layer(context, info.layers[i], layers)); }
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime::api
