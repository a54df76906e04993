#include "compositor/layer_views.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace entoptic::compositor {
namespace {

// Rows of a projective map of directions (x, y, z) in eye axes to texels.
struct DirectionMap {
    glm::dvec3 x, y, w;
};

struct DoublePose {
    glm::dquat orientation;
    glm::dvec3 position;
};

DoublePose as_double(const Pose& pose) { return {glm::normalize(glm::dquat(pose.orientation)), glm::dvec3(pose.position)}; }
DoublePose inverse(const DoublePose& p) {
    const glm::dquat back = glm::conjugate(p.orientation);
    return {back, -(back * p.position)};
}
DoublePose operator*(const DoublePose& a, const DoublePose& b) {
    return {a.orientation * b.orientation, a.orientation * b.position + a.position};
}

DoublePose space_from_eye(const Layer& layer, const EyePlace& place) {
    const DoublePose head_from_eye = as_double(place.head_from_eye), anchor_from_space = as_double(layer.anchor);
    if (layer.head_locked) return inverse(anchor_from_space) * head_from_eye;
    return inverse(anchor_from_space) * as_double(place.world_from_head) * head_from_eye;
}

// Rows of the rotation matrix: row i gives component i of the turned direction.
std::array<glm::dvec3, 3> rows_of(const glm::dquat& rotation) {
    const glm::dmat3 m = glm::transpose(glm::mat3_cast(rotation));
    return {m[0], m[1], m[2]};
}

std::optional<DirectionMap> projection_map(const entoptic::LayerView& view, const DoublePose& eye) {
    const double left = std::tan(double(view.fov.angle_left)), right = std::tan(double(view.fov.angle_right));
    const double up = std::tan(double(view.fov.angle_up)), down = std::tan(double(view.fov.angle_down));
    if (!(std::abs(right - left) > 1e-9) || !(std::abs(up - down) > 1e-9)) return std::nullopt;
    const auto d = rows_of(glm::conjugate(as_double(view.space_from_view).orientation) * eye.orientation);
    const glm::dvec3 w = -d[2];
    const SubImage& image = view.image;
    return DirectionMap{double(image.x) * w + (d[0] - left * w) * (image.width / (right - left)),
                        double(image.y) * w + (up * w - d[1]) * (image.height / (up - down)), w};
}

std::optional<DirectionMap> quad_map(const Layer& layer, const SubImage& image, const DoublePose& eye) {
    const DoublePose quad_from_eye = inverse(as_double(layer.space_from_quad)) * eye;
    const glm::dvec3 from = quad_from_eye.position;
    if (!(layer.quad_width_m > 0) || !(layer.quad_height_m > 0) || !(from.z > 0)) return std::nullopt;
    const auto d = rows_of(quad_from_eye.orientation);
    const glm::dvec3 w = -d[2];
    const glm::dvec3 across = from.z * d[0] + from.x * w, up = from.z * d[1] + from.y * w;  // times 1/w: metres from the quad's centre
    return DirectionMap{double(image.x) * w + (across / double(layer.quad_width_m) + 0.5 * w) * double(image.width),
                        double(image.y) * w + (0.5 * w - up / double(layer.quad_height_m)) * double(image.height), w};
}

// The direction seen at lens coordinates (p.x, p.y, D), times D: see lens_tangents() of shaders/geometry.glsl.
vec3 through_lens(const glm::dvec3& row, const EyeGeometry& g, const LensChannel& c) {
    const double fx = g.focal.x, fy = g.focal.y, aspect = g.aspect;
    return {static_cast<float>(row.x / fx), static_cast<float>(-row.y * aspect / fy),
            static_cast<float>(row.x * (double(c.centre.x) + double(g.principal_point.x)) / fx +
                               row.y * (double(g.principal_point.y) - double(c.centre.y) * aspect) / fy - row.z)};
}

uint flags_of(const Layer& layer, bool is_float) {
    return (layer.blend_texture_source_alpha ? layer_blends : 0u) |
           (layer.blend_texture_source_alpha && layer.unpremultiplied_alpha ? layer_unpremultiplied : 0u) |
           (is_float ? layer_is_float : 0u);
}

bool hidden_from(const Layer& layer, int eye) { return layer.visibility == (eye == 0 ? EyeVisibility::right : EyeVisibility::left); }

}  // namespace

std::optional<LayerView> layer_view(const Layer& layer, int eye, const EyePlace& place, const EyeGeometry& geometry, bool is_float) {
    const auto& source = layer.views[layer.kind == LayerKind::projection ? static_cast<std::size_t>(eye) : 0];
    if (hidden_from(layer, eye) || source.image.width <= 0 || source.image.height <= 0) return std::nullopt;
    LayerView view{};
    const DoublePose from_eye = space_from_eye(layer, place);
    const auto map = layer.kind == LayerKind::projection ? projection_map(source, from_eye) : quad_map(layer, source.image, from_eye);
    if (!map) return std::nullopt;
    for (std::size_t c = 0; c < 3; ++c) {
        view.texel_from_lens[3 * c] = through_lens(map->x, geometry, geometry.channels[c]);
        view.texel_from_lens[3 * c + 1] = through_lens(map->y, geometry, geometry.channels[c]);
        view.texel_from_lens[3 * c + 2] = through_lens(map->w, geometry, geometry.channels[c]);
    }
    view.low = {source.image.x, source.image.y};
    view.high = view.low + vec2(source.image.width, source.image.height);
    view.clamp_low = view.low + 0.5f;
    view.clamp_high = view.high - 0.5f;
    view.cd_per_unit = layer.luminance.cd_per_unit;
    view.offset_cd = layer.luminance.offset_cd;
    view.flags = flags_of(layer, is_float);
    return view;
}

namespace {

// Distance along its axis, as 1/m, of what a depth image holds; false when the numbers cannot be used.
bool read_range(const LayerDepth& depth, DepthLayer& into) {
    const double span = double(depth.max_depth) - double(depth.min_depth);
    if (!(depth.near_z_m > 0) || !(depth.far_z_m > 0) || depth.near_z_m == depth.far_z_m || !(span > 0)) return false;
    const double near = 1 / double(depth.near_z_m), far = 1 / double(depth.far_z_m);
    const double per_unit = (far - near) / span;
    into.dioptre_per_unit = static_cast<float>(per_unit);
    into.dioptre_at_zero = static_cast<float>(near - per_unit * double(depth.min_depth));
    into.least = depth.min_depth;
    into.most = depth.max_depth;
    return true;
}

// Distance of the eye from the quad's plane.
double plane_distance(const Layer& layer, const EyePlace& place) {
    return (inverse(as_double(layer.space_from_quad)) * space_from_eye(layer, place)).position.z;
}

}  // namespace

std::optional<DepthLayer> depth_layer(const Layer& layer, int eye, const EyePlace& place, const EyeGeometry& geometry) {
    const auto colour = layer_view(layer, eye, place, geometry, false);
    if (!colour) return std::nullopt;
    DepthLayer into{};
    std::copy_n(colour->texel_from_lens + 3, 3, into.colour_from_lens);
    into.low = colour->low;
    into.high = colour->high;
    into.flags = (colour->flags & layer_blends) != 0 ? depth_blends : 0u;
    if (layer.kind == LayerKind::quad) {
        into.flags |= depth_known;
        into.dioptre_at_zero = static_cast<float>(1 / plane_distance(layer, place));
        return into;
    }
    const LayerDepth& depth = layer.views[std::size_t(eye)].depth;
    if (depth.image.width <= 0 || depth.image.height <= 0 || !read_range(depth, into)) return into;
    Layer its_depth = layer;  // seen from the same place, with texels of its own
    its_depth.views[std::size_t(eye)].image = depth.image;
    const auto view = layer_view(its_depth, eye, place, geometry, false);
    std::copy_n(view->texel_from_lens + 3, 3, into.depth_from_lens);
    into.depth_low = view->clamp_low;
    into.depth_high = view->clamp_high;
    into.flags |= depth_known | depth_sampled;
    return into;
}

}  // namespace entoptic::compositor
