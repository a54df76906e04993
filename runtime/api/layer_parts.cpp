#include "runtime/api/layer_parts.h"

#include "runtime/api/verify.h"
#include "runtime/objects/session.h"
#include "runtime/objects/swapchain.h"

#include <array>
#include <cmath>

namespace entoptic::runtime::api {

namespace {

constexpr float pi = 3.14159265f, half_turn_eps = 1e-4f;

Outcome check_rectangle(const XrRect2Di& rect, const XrSwapchainCreateInfo& info) {
    const std::int64_t right = std::int64_t(rect.offset.x) + rect.extent.width, bottom = std::int64_t(rect.offset.y) + rect.extent.height;
    const bool inside = rect.offset.x >= 0 && rect.offset.y >= 0 && rect.extent.width >= 0 && rect.extent.height >= 0 &&
                        right <= std::int64_t(info.width) && bottom <= std::int64_t(info.height);
    if (inside) return XR_SUCCESS;
    return error(XR_ERROR_SWAPCHAIN_RECT_INVALID, "imageRect {}x{} at ({}, {}) does not lie inside the swapchain's {}x{} texels",
                 rect.extent.width, rect.extent.height, rect.offset.x, rect.offset.y, info.width, info.height);
}

Outcome check_radius(float radius) {
    return radius >= 0 ? Outcome() : invalid("the radius {} must not be negative", radius);  // false for NaN; infinite is infinite
}

Outcome resolve_surface(const LayerContext& context, const XrSwapchainSubImage& image, XrEyeVisibility visibility, const XrPosef& pose,
                        float radius, Layer& layer) {
    ENTOPTIC_XR_TRY(resolve_visibility(visibility, layer));
    ENTOPTIC_XR_TRY(check_pose(pose));
    ENTOPTIC_XR_TRY(check_radius(radius));
    ENTOPTIC_XR_TRY(resolve_sub_image(context, image, Holds::colour, layer.views[0].image));
    layer.views[1].image = layer.views[0].image;
    layer.surface.space_from_centre = to_pose(pose);
    layer.surface.radius_m = radius;
    return XR_SUCCESS;
}

// How an eye in the middle of a cube looks at one face of it: directions of the face's image to the right, up and out. Cube maps are
// mirrored as seen from within (the tables of OpenGL and Vulkan), so the view's field is turned over.
struct CubeFace {
    glm::vec3 view_right, view_up;
};
constexpr std::array<CubeFace, 6> cube_faces{{{{0, 0, 1}, {0, 1, 0}},    // +x
                                              {{0, 0, -1}, {0, 1, 0}},   // -x
                                              {{-1, 0, 0}, {0, 0, -1}},  // +y
                                              {{-1, 0, 0}, {0, 0, 1}},   // -y
                                              {{-1, 0, 0}, {0, 1, 0}},   // +z
                                              {{1, 0, 0}, {0, 1, 0}}}};  // -z

Pose face_pose(const CubeFace& face) {
    const glm::vec3 back = glm::cross(face.view_right, face.view_up);
    return {glm::normalize(glm::quat_cast(glm::mat3(face.view_right, face.view_up, back))), glm::vec3(0)};
}

}  // namespace

Outcome resolve_sub_image(const LayerContext& context, const XrSwapchainSubImage& given, Holds holds, SubImage& image, bool cube) {
    std::shared_ptr<Swapchain> swapchain;
    ENTOPTIC_XR_TRY(find(given.swapchain, swapchain));
    if (swapchain->session() != context.session) return invalid("the layer's swapchain belongs to another session");
    const XrSwapchainCreateInfo& info = swapchain->info();
    if ((info.faceCount == 6) != cube) {
        return invalid("the swapchain has {} faces; {}", info.faceCount, cube ? "a cube layer needs 6" : "only cube layers can show 6");
    }
    if (given.imageArrayIndex >= info.arraySize) {
        return invalid("imageArrayIndex {} is beyond the swapchain's {} slices", given.imageArrayIndex, info.arraySize);
    }
    ENTOPTIC_XR_TRY(check_rectangle(given.imageRect, info));
    const bool depth = (info.usageFlags & XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT) != 0;
    if (depth && holds == Holds::colour) return error(XR_ERROR_LAYER_INVALID, "a depth swapchain cannot be shown as a layer");
    if (!depth && holds == Holds::depth) {
        return error(XR_ERROR_LAYER_INVALID, "a layer's depth needs a swapchain made with XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT");
    }
    ENTOPTIC_XR_TRY(swapchain->take_for_layer(image.image_index));
    image.swapchain = swapchain->id();
    image.array_layer = given.imageArrayIndex;
    image.x = given.imageRect.offset.x;
    image.y = given.imageRect.offset.y;
    image.width = given.imageRect.extent.width;
    image.height = given.imageRect.extent.height;
    // OpenGL's and Vulkan's tables of cube faces say the same of a texel in memory.
    image.bottom_up = !cube && context.session->graphics()->bottom_up();
    return XR_SUCCESS;
}

Outcome resolve_visibility(XrEyeVisibility given, Layer& layer) {
    switch (given) {
        case XR_EYE_VISIBILITY_BOTH:
            layer.visibility = EyeVisibility::both;
            return XR_SUCCESS;
        case XR_EYE_VISIBILITY_LEFT:
            layer.visibility = EyeVisibility::left;
            return XR_SUCCESS;
        case XR_EYE_VISIBILITY_RIGHT:
            layer.visibility = EyeVisibility::right;
            return XR_SUCCESS;
        default:
            return invalid("{} is not an eye visibility", static_cast<int>(given));
    }
}

Outcome resolve_cylinder(const LayerContext& context, const XrCompositionLayerCylinderKHR& given, Layer& layer) {
    layer.kind = LayerKind::cylinder;
    if (!(given.centralAngle >= 0 && given.centralAngle < 2 * pi))
        return invalid("centralAngle {} must lie in [0, 2π)", given.centralAngle);
    if (!(given.aspectRatio > 0) || !std::isfinite(given.aspectRatio)) return invalid("aspectRatio {} must be positive", given.aspectRatio);
    ENTOPTIC_XR_TRY(resolve_surface(context, given.subImage, given.eyeVisibility, given.pose, given.radius, layer));
    const bool infinite = given.radius == 0 || std::isinf(given.radius);
    layer.surface.longitude_extent = given.centralAngle;
    layer.surface.height_m = (infinite ? 1.0f : given.radius) * given.centralAngle / given.aspectRatio;
    return XR_SUCCESS;
}

// The texture coordinates of the whole sphere, times scale, plus bias: what of them lies within 0..1 is the image.
Outcome resolve_equirect(const LayerContext& context, const XrCompositionLayerEquirectKHR& given, Layer& layer) {
    layer.kind = LayerKind::equirect;
    for (const float value : {given.scale.x, given.scale.y, given.bias.x, given.bias.y}) {
        if (!std::isfinite(value)) return invalid("scale and bias must be finite");
    }
    ENTOPTIC_XR_TRY(resolve_surface(context, given.subImage, given.eyeVisibility, given.pose, given.radius, layer));
    CurvedSurface& surface = layer.surface;
    if (!(given.scale.x > 0) || !(given.scale.y > 0)) {  // no part of the sphere
        layer.views[0].image.width = layer.views[1].image.width = 0;
        return XR_SUCCESS;
    }
    // u = (longitude / 2π + 1/2) scale + bias, v = (1/2 - latitude / π) scale + bias.
    surface.longitude_extent = 2 * pi / given.scale.x;
    surface.longitude_centre = 2 * pi * ((0.5f - given.bias.x) / given.scale.x - 0.5f);
    surface.latitude_top = pi * (0.5f + given.bias.y / given.scale.y);
    surface.latitude_bottom = pi * (0.5f - (1 - given.bias.y) / given.scale.y);
    return XR_SUCCESS;
}

Outcome resolve_equirect2(const LayerContext& context, const XrCompositionLayerEquirect2KHR& given, Layer& layer) {
    layer.kind = LayerKind::equirect;
    const float half = pi / 2 + half_turn_eps;
    if (!(given.centralHorizontalAngle >= 0 && given.centralHorizontalAngle <= 2 * pi + half_turn_eps)) {
        return invalid("centralHorizontalAngle {} must lie in [0, 2π]", given.centralHorizontalAngle);
    }
    if (!(std::abs(given.upperVerticalAngle) <= half && std::abs(given.lowerVerticalAngle) <= half)) {
        return invalid("the vertical angles {} and {} must lie in [-π/2, π/2]", given.upperVerticalAngle, given.lowerVerticalAngle);
    }
    ENTOPTIC_XR_TRY(resolve_surface(context, given.subImage, given.eyeVisibility, given.pose, given.radius, layer));
    layer.surface.longitude_extent = given.centralHorizontalAngle;
    layer.surface.latitude_top = given.upperVerticalAngle;
    layer.surface.latitude_bottom = given.lowerVerticalAngle;
    return XR_SUCCESS;
}

Outcome resolve_cube(const LayerContext& context, const XrCompositionLayerCubeKHR& given, const Layer& base, bool shown,
                     std::vector<Layer>& layers) {
    Layer face = base;
    ENTOPTIC_XR_TRY(resolve_visibility(given.eyeVisibility, face));
    ENTOPTIC_XR_TRY(check_pose({given.orientation, {0, 0, 0}}));
    std::shared_ptr<Swapchain> swapchain;
    ENTOPTIC_XR_TRY(find(given.swapchain, swapchain));
    const auto side = static_cast<std::int32_t>(swapchain->info().width);
    SubImage image;
    ENTOPTIC_XR_TRY(
        resolve_sub_image(context, {given.swapchain, {{0, 0}, {side, side}}, given.imageArrayIndex}, Holds::colour, image, true));
    const Pose turned = to_pose({given.orientation, {0, 0, 0}});
    for (std::uint32_t i = 0; shown && i < cube_faces.size(); ++i) {
        for (LayerView& view : face.views) {
            view.image = image;
            view.image.array_layer = 6 * given.imageArrayIndex + i;
            view.fov = {pi / 4, -pi / 4, pi / 4, -pi / 4};
            view.space_from_view = turned * face_pose(cube_faces[i]);
        }
        layers.push_back(face);
    }
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime::api
