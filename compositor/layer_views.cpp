#include "compositor/layer_views.h"

#include <algorithm>
#include <cmath>
#include <iterator>
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
           (is_float ? layer_is_float : 0u) | (layer.tint == LayerTint{} ? 0u : layer_tinted) |
           (layer.replaces_previous ? layer_replaces : 0u);
}

bool is_curved(LayerKind kind) { return kind == LayerKind::cylinder || kind == LayerKind::equirect; }

void copy_tint(const LayerTint& tint, LayerView& view) {
    for (int i = 0; i < 4; ++i) {
        view.colour_scale[i] = tint.scale[std::size_t(i)];
        view.colour_bias[i] = tint.bias[std::size_t(i)];
    }
}

// Directions in the surface's axes, and the rest of the way to a texel in `view` (compositor/layer_view.h).
std::optional<DirectionMap> curved_map(const Layer& layer, const SubImage& image, const DoublePose& eye, LayerView& view) {
    const CurvedSurface& surface = layer.surface;
    const bool cylinder = layer.kind == LayerKind::cylinder;
    const double up = cylinder ? double(surface.height_m) : double(surface.latitude_top) - double(surface.latitude_bottom);
    const double turn = surface.longitude_extent;
    if (!(turn > 0) || !(up > 0) || !std::isfinite(up)) return std::nullopt;
    const DoublePose from_eye = inverse(as_double(surface.space_from_centre)) * eye;
    const bool infinite = !(surface.radius_m > 0) || !std::isfinite(surface.radius_m);
    view.origin = infinite ? vec3(0) : vec3(from_eye.position);
    view.radius = infinite ? 1.0f : surface.radius_m;
    const double top = cylinder ? up / 2 : double(surface.latitude_top);
    view.texel_scale = {static_cast<float>(image.width / turn), static_cast<float>(-image.height / up)};
    view.texel_bias = {static_cast<float>(image.x + image.width * (0.5 - double(surface.longitude_centre) / turn)),
                       static_cast<float>(image.y + image.height * top / up)};
    view.flags |= cylinder ? layer_cylinder : layer_sphere;
    const auto d = rows_of(from_eye.orientation);
    return DirectionMap{d[0], d[1], d[2]};
}

std::optional<DirectionMap> upright_map(const Layer& layer, const entoptic::LayerView& source, const DoublePose& eye, LayerView& view) {
    switch (layer.kind) {
        case LayerKind::projection:
            return projection_map(source, eye);
        case LayerKind::quad:
            return quad_map(layer, source.image, eye);
        default:
            return curved_map(layer, source.image, eye, view);
    }
}

// The same for pictures whose lowest row comes first: row y of the sub-image counts from its other edge.
std::optional<DirectionMap> direction_map(const Layer& layer, const entoptic::LayerView& source, const DoublePose& eye, LayerView& view) {
    auto map = upright_map(layer, source, eye, view);
    if (!map || !source.image.bottom_up) return map;
    const double both_edges = 2.0 * source.image.y + source.image.height;
    if (is_curved(layer.kind)) {
        view.texel_scale.y = -view.texel_scale.y;
        view.texel_bias.y = static_cast<float>(both_edges) - view.texel_bias.y;
    } else {
        map->y = both_edges * map->w - map->y;
    }
    return map;
}

// choice: bilinear interpolation reads every texel while a pixel's neighbours look no more than two texels on.
constexpr double footprint_without_averaging = 2;
constexpr int footprint_grid = 9;  // points a side at which the footprint is looked at

// Position on the panel about the green lens's optical centre at which a direction is seen: the radius that the distortion takes there.
glm::dvec2 lens_point(const EyeGeometry& g, glm::dvec2 tangents) {
    const LensChannel& c = g.channels[1];
    const glm::dvec2 shown{tangents.x * double(g.focal.x) - double(g.principal_point.x) - double(c.centre.x),
                           (double(g.principal_point.y) - tangents.y * double(g.focal.y)) / double(g.aspect) - double(c.centre.y)};
    const double target = glm::length(shown);
    if (target == 0) return shown;
    const auto gain = [&](double r) {
        const double r2 = r * r;
        return r / (1 + r2 * (double(c.coefficients.x) + r2 * (double(c.coefficients.y) + r2 * double(c.coefficients.z))));
    };
    double low = 0, high = std::sqrt(std::max(double(g.r2_cutoff.y), 1e-6));
    for (int i = 0; i < 30; ++i) (gain((low + high) / 2) < target ? low : high) = (low + high) / 2;
    return shown * (low / target);
}

std::optional<glm::dvec2> texel_at(const LayerView& view, const EyeGeometry& g, glm::dvec2 p) {
    const glm::dvec3 k(g.channels[1].coefficients);
    const double r2 = glm::dot(p, p);
    const glm::dvec3 at(p, 1 + r2 * (k.x + r2 * (k.y + r2 * k.z)));
    const glm::dvec3 h{glm::dot(glm::dvec3(view.texel_from_lens[3]), at), glm::dot(glm::dvec3(view.texel_from_lens[4]), at),
                       glm::dot(glm::dvec3(view.texel_from_lens[5]), at)};
    if ((view.flags & (layer_cylinder | layer_sphere)) != 0) {  // as if from the middle: a footprint need not be exact
        const glm::dvec3 d = glm::normalize(h);
        const double along = (view.flags & layer_sphere) != 0 ? std::asin(d.y) : double(view.radius) * d.y / std::hypot(d.x, d.z);
        return glm::dvec2(std::atan2(d.x, -d.z), along) * glm::dvec2(view.texel_scale) + glm::dvec2(view.texel_bias);
    }
    if (!(h.z > 0)) return std::nullopt;
    return glm::dvec2(h) / h.z;
}

// Texels from a pixel to its farther neighbour, where the layer is seen; else 0.
double footprint_at(const LayerView& view, const EyeGeometry& g, glm::dvec2 p) {
    const auto here = texel_at(view, g, p);
    const auto right = texel_at(view, g, p + glm::dvec2(2.0 / g.width, 0));
    const auto below = texel_at(view, g, p + glm::dvec2(0, 2.0 / (double(g.height) * double(g.aspect))));
    if (!here || !right || !below) return 0;
    const bool seen =
        here->x >= double(view.low.x) && here->y >= double(view.low.y) && here->x <= double(view.high.x) && here->y <= double(view.high.y);
    if (!seen) return 0;
    const double across = glm::length(*right - *here), down = glm::length(*below - *here);
    const double back = 3 * std::abs(double(view.texel_scale.x));  // half a turn of a curved layer: its seam
    return (back > 0 && across > back) || !(std::max(across, down) < 1e9) ? 0 : std::max(across, down);
}

// The largest of a grid over the panel and, for what may lie between its points, of the layer's own middle and corners.
double largest_footprint(const LayerView& view, const EyeGeometry& g, const DirectionMap& map) {
    double largest = 0;
    for (int i = 0; i < footprint_grid * footprint_grid; ++i) {
        const glm::dvec2 uv{(i % footprint_grid + 0.5) / footprint_grid, (i / footprint_grid + 0.5) / footprint_grid};
        const glm::dvec2 p{2 * uv.x - 1 - double(g.channels[1].centre.x),
                           (2 * uv.y - 1) / double(g.aspect) - double(g.channels[1].centre.y)};
        if (glm::dot(p, p) <= double(g.r2_cutoff.y)) largest = std::max(largest, footprint_at(view, g, p));
    }
    if ((view.flags & (layer_cylinder | layer_sphere)) != 0) return largest;
    const glm::dmat3 direction_from_texel = glm::inverse(glm::transpose(glm::dmat3(map.x, map.y, map.w)));
    for (const glm::dvec2 part :
         {glm::dvec2(0.5), glm::dvec2(0.1, 0.1), glm::dvec2(0.9, 0.1), glm::dvec2(0.1, 0.9), glm::dvec2(0.9, 0.9)}) {
        const glm::dvec2 texel = glm::mix(glm::dvec2(view.low), glm::dvec2(view.high), part);
        const glm::dvec3 direction = direction_from_texel * glm::dvec3(texel, 1);
        if (direction.z < -1e-9) largest = std::max(largest, footprint_at(view, g, lens_point(g, glm::dvec2(direction) / -direction.z)));
    }
    return largest;
}

// Tangents of a box about everything that the lens shows, with a tenth to spare for the other colours.
glm::dvec2 widest_tangents(const EyeGeometry& g) {
    const LensChannel& c = g.channels[1];
    glm::dvec2 widest(0);
    for (int i = 0; i < 32; ++i) {
        const double angle = i * 0.19634954084936207;  // a sixteenth of pi
        glm::dvec2 p{std::cos(angle), std::sin(angle)};
        const glm::dvec2 edge{1 + std::abs(double(c.centre.x)), 1 / double(g.aspect) + std::abs(double(c.centre.y))};
        p *= std::min({std::sqrt(double(g.r2_cutoff.y)), edge.x / std::max(std::abs(p.x), 1e-9), edge.y / std::max(std::abs(p.y), 1e-9)});
        const double r2 = glm::dot(p, p);
        const double gain = 1 / (1 + r2 * (double(c.coefficients.x) + r2 * (double(c.coefficients.y) + r2 * double(c.coefficients.z))));
        widest.x =
            std::max(widest.x, (std::abs(p.x * gain + double(c.centre.x)) + std::abs(double(g.principal_point.x))) / double(g.focal.x));
        widest.y =
            std::max(widest.y, (std::abs(p.y * gain + double(c.centre.y)) * double(g.aspect) + std::abs(double(g.principal_point.y))) /
                                   double(g.focal.y));
    }
    return widest * 1.1;
}

// True when everything that the eye can see lies on the outer side of one edge of the layer's sub-image, or behind it.
bool out_of_sight(const DirectionMap& map, const LayerView& view, const EyeGeometry& g) {
    const glm::dvec2 widest = widest_tangents(g);
    const glm::dvec3 sides[] = {map.w, map.x - double(view.low.x) * map.w, double(view.high.x) * map.w - map.x,
                                map.y - double(view.low.y) * map.w, double(view.high.y) * map.w - map.y};
    return std::any_of(std::begin(sides), std::end(sides), [&](const glm::dvec3& side) {
        // Linear in the tangents: largest in a corner.
        return std::abs(side.x) * widest.x + std::abs(side.y) * widest.y - side.z < 0;
    });
}

bool hidden_from(const Layer& layer, int eye) { return layer.visibility == (eye == 0 ? EyeVisibility::right : EyeVisibility::left); }

}  // namespace

std::optional<LayerView> layer_view(const Layer& layer, int eye, const EyePlace& place, const EyeGeometry& geometry, bool is_float) {
    const auto& source = layer.views[layer.kind == LayerKind::projection ? static_cast<std::size_t>(eye) : 0];
    if (hidden_from(layer, eye) || source.image.width <= 0 || source.image.height <= 0) return std::nullopt;
    LayerView view{};
    const DoublePose from_eye = space_from_eye(layer, place);
    const auto map = direction_map(layer, source, from_eye, view);
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
    view.flags |= flags_of(layer, is_float);
    copy_tint(layer.tint, view);
    if (!is_curved(layer.kind) && out_of_sight(*map, view, geometry)) return std::nullopt;
    if (largest_footprint(view, geometry, *map) > footprint_without_averaging) view.flags |= layer_minified;
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
    if (is_curved(layer.kind)) return std::nullopt;
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
