#include "perception/glare/glare_grid.h"

#include "perception/glare/glare_math.glsl"
#include "shaders/geometry.glsl"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

constexpr double pi = 3.14159265358979323846;
// Texels may be so much wider than asked for before the grid takes twice as many: a full eye of a Vive Pro has 1.09.
constexpr double most_widened = 1.1;
// Of a foveated image the near field must be resolved where pixels are smallest, in the fovea: 16 of these pixels are 22.4 there, within
// max_near_px.
constexpr double foveated_pixel_widening = 1.4;
glm::dvec3 direction_at(const EyeGeometry& g, double x, double y) { return geometry::geometry_direction(g, {x, y}); }

GlarePatch patch_towards(uint view, glm::dvec3 forward) {
    GlarePatch patch;
    patch.view = view;
    patch.forward = glm::normalize(forward);
    const glm::dvec3 helper = std::abs(patch.forward.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
    patch.right = glm::normalize(glm::cross(patch.forward, helper));
    patch.up = glm::cross(patch.right, patch.forward);
    return patch;
}

glm::dvec2 angles_in(const GlarePatch& patch, glm::dvec3 direction) {
    return glare::grid_offset(patch.right, patch.up, patch.forward, 1.0, direction);
}

// What a view looks like, from samples of its visible pixels.
struct ViewField {
    GlarePatch patch;               // about the middle of the field
    double half_x = 0, half_y = 0;  // rad
    double pixel = 0;               // mean step, rad
    double smallest_step = 1;       // rad
};

std::vector<glm::dvec2> visible_samples(const EyeGeometry& g) {
    std::vector<glm::dvec2> samples;
    constexpr int n = 48;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const glm::dvec2 px{0.5 + (g.width - 1.0) * i / n, 0.5 + (g.height - 1.0) * j / n};
            if (geometry::geometry_visible(g, px)) samples.push_back(px);
        }
    if (samples.empty()) samples.push_back({g.width * 0.5, g.height * 0.5});
    return samples;
}

void measure_pixels(const EyeGeometry& g, const std::vector<glm::dvec2>& samples, ViewField& field) {
    for (const glm::dvec2& px : samples) {
        const double across = glm::length(direction_at(g, px.x + 0.5, px.y) - direction_at(g, px.x - 0.5, px.y));
        const double down = glm::length(direction_at(g, px.x, px.y + 0.5) - direction_at(g, px.x, px.y - 0.5));
        field.pixel += std::sqrt(across * down) / static_cast<double>(samples.size());
        field.smallest_step = std::min({field.smallest_step, across, down});
    }
    if (g.kind == geometry_foveated) field.pixel = foveated_pixel_widening * field.smallest_step;
}

ViewField field_of(const EyeGeometry& g, uint view) {
    ViewField field;
    const std::vector<glm::dvec2> samples = visible_samples(g);
    measure_pixels(g, samples, field);
    glm::dvec3 forward{0};
    for (const glm::dvec2& px : samples) forward += direction_at(g, px.x, px.y);
    field.patch = patch_towards(view, glm::length(forward) > 1e-6 ? forward : glm::dvec3(0, 0, -1));
    for (int iteration = 0; iteration < 4; ++iteration) {
        glm::dvec2 low{10}, high{-10};
        for (const glm::dvec2& px : samples) {
            const glm::dvec2 at = angles_in(field.patch, direction_at(g, px.x, px.y));
            low = glm::min(low, at);
            high = glm::max(high, at);
        }
        field.half_x = 0.5 * (high.x - low.x);
        field.half_y = 0.5 * (high.y - low.y);
        const glm::dvec2 centre = 0.5 * (low + high);
        if (iteration < 3)
            field.patch =
                patch_towards(view, field.patch.forward + std::tan(centre.x) * field.patch.right - std::tan(centre.y) * field.patch.up);
    }
    return field;
}

// A sphere: patches about the middles of a cube's faces, edges and corners. Light is shared out among the patches whose axes are near it, where directions
// are as far from each other on the plane as they are on the sphere, and veils a whole patch: all directions nearer to the axis than sphere_reach.
// Kernels end at 110 degrees, which is as far as a source may be from what it veils; the plane repeats after sphere_period, so that a source does not
// veil what lies behind it the long way round.
constexpr double sphere_source = 30 * pi / 180, sphere_reach = 140 * pi / 180, sphere_period = 280 * pi / 180;
constexpr uint sphere_patches = 26;
// Texels are not wider than this, or a pixel: those of a small panorama are coarse enough.
constexpr double sphere_texel = 0.5 * pi / 180;
std::vector<glm::dvec3> sphere_axes() {
    std::vector<glm::dvec3> axes;
    for (int i = 0; i < 27; ++i)
        if (i != 13) axes.push_back(glm::normalize(glm::dvec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
    return axes;
}

double smooth(double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}
// Share of a patch in the light from a direction, before the sum over all is set to 1; none beyond sphere_source.
double source_share(const GlarePatch& patch, glm::dvec3 d) {
    const double edge = std::cos(sphere_source);
    return smooth((glm::dot(patch.forward, d) - edge) / (1 - edge));
}
// Of a patch in the veil towards a direction: 1, and 0 where no source of its reaches and the plane is torn.
double veil_share(const GlarePatch& patch, glm::dvec3 d) { return glm::dot(patch.forward, d) > std::cos(sphere_reach) ? 1 : 0; }

void choose_patches(std::span<const EyeGeometry> views, double texel_px, uint least_texels, GlareGrid& grid) {
    double reach_x = 0, reach_y = 0, pixel = 0, period = 0;
    grid.smallest_step = 1;
    for (uint view = 0; view < views.size(); ++view) {
        const EyeGeometry& g = views[view];
        if (g.kind == geometry_equirect) {
            for (const glm::dvec3& axis : sphere_axes()) grid.patches.push_back(patch_towards(view, axis));
            grid.taps = sphere_patches;
            reach_x = reach_y = sphere_reach;
            period = sphere_period;
            pixel = std::max(pixel, pi / g.height);
            grid.smallest_step = std::min(grid.smallest_step, pi / g.height);
            continue;
        }
        const ViewField field = field_of(g, view);
        grid.patches.push_back(field.patch);
        reach_x = std::max(reach_x, field.half_x);
        reach_y = std::max(reach_y, field.half_y);
        pixel = std::max(pixel, field.pixel);
        grid.smallest_step = std::min(grid.smallest_step, field.smallest_step);
    }
    grid.pixel_rad = pixel;
    if (period == 0)
        period = 2 * std::max(reach_x, reach_y) / glare_occupied;
    else
        texel_px = std::clamp(sphere_texel / pixel, 1.0, texel_px);
    const double texels = period / (texel_px * pixel);
    grid.n = least_texels;
    while (grid.n < glare_n && grid.n * most_widened < texels) grid.n *= 2;
    grid.pitch = texel_px * pixel * std::max(texels / grid.n, 1.0);
    // Nodes lie up to 16 pixels outside the picture, texels of a tap one further.
    const double rows = std::min(reach_y / grid.pitch + 4 + 16 * pixel / grid.pitch, grid.n / 2 - 2.0);
    grid.first_row = grid.n / 2 - static_cast<uint>(std::ceil(rows));
    grid.rows = 2 * static_cast<uint>(std::ceil(rows)) + 1;
    grid.step = 1;
    while (grid.step < 8 && 2 * grid.step * pixel <= grid.pitch * 1.01) grid.step *= 2;
    grid.damping = 6 + 6 * std::pow(grid.step * pixel / grid.pitch, 2);
}

NodeTap tap_of(const GlareGrid& grid, uint patch_index, glm::dvec3 d, double weight) {
    const glm::dvec2 at = angles_in(grid.patches[patch_index], d) / grid.pitch;
    const double middle = grid.n / 2, low_x = 2, high_x = grid.n - 3.0, low_y = grid.first_row + 1.0,
                 high_y = grid.first_row + grid.rows - 2.0;
    const auto within = [](double t, double low, double high) { return std::isfinite(t) ? std::clamp(t, low, high) : low; };
    return {patch_index, static_cast<float>(within(middle + at.x, low_x, high_x)), static_cast<float>(within(middle + at.y, low_y, high_y)),
            static_cast<float>(weight)};
}

struct PendingEntry {
    uint texel;  // patch, row, column
    SplatEntry entry;
};

void add_splat(const NodeTap& tap, uint node, std::vector<PendingEntry>& pending) {
    const auto x = static_cast<uint>(tap.u + 0.5f), y = static_cast<uint>(tap.v + 0.5f);
    const glm::dvec3 across = glare::spline_weights(static_cast<double>(tap.u) - x);
    const glm::dvec3 down = glare::spline_weights(static_cast<double>(tap.v) - y);
    for (uint k = 0; k < 9; ++k) {
        const double w = across[static_cast<int>(k % 3)] * down[static_cast<int>(k / 3)] * static_cast<double>(tap.weight);
        if (w > 0)
            pending.push_back({(tap.patch_index * glare_n + y + k / 3 - 1) * glare_n + x + k % 3 - 1, {node, static_cast<float>(w)}});
    }
}

// Counting sort by texel; inside a texel the order of nodes stays, so that sums have one order.
void sort_splats(const std::vector<PendingEntry>& pending, GlareGrid& grid) {
    grid.splat_offsets.assign(grid.patches.size() * glare_n * glare_n + 1, 0);
    for (const PendingEntry& p : pending) ++grid.splat_offsets[p.texel + 1];
    for (std::size_t i = 1; i < grid.splat_offsets.size(); ++i) grid.splat_offsets[i] += grid.splat_offsets[i - 1];
    std::vector<uint> next(grid.splat_offsets.begin(), grid.splat_offsets.end() - 1);
    grid.splat_entries.resize(pending.size());
    for (const PendingEntry& p : pending) grid.splat_entries[next[p.texel]++] = p.entry;
}

void place_nodes(std::span<const EyeGeometry> views, GlareGrid& grid) {
    grid.nodes_x = (views[0].width - 1 + grid.step / 2) / grid.step + 3;
    grid.nodes_y = (views[0].height - 1 + grid.step / 2) / grid.step + 3;
    std::vector<PendingEntry> pending;
    uint first_patch = 0;
    for (uint view = 0; view < views.size(); ++view) {
        const EyeGeometry& g = views[view];
        const uint patches = g.kind == geometry_equirect ? sphere_patches : 1;
        for (uint i = 0; i < grid.nodes_x * grid.nodes_y; ++i) {
            const double x = (static_cast<double>(i % grid.nodes_x) - 1) * grid.step + 0.5,
                         y = (static_cast<double>(i / grid.nodes_x) - 1) * grid.step + 0.5;
            const glm::dvec3 d = direction_at(g, x, y);
            const uint node = view * grid.nodes_x * grid.nodes_y + i;
            if (patches == 1) {
                grid.node_taps.push_back(tap_of(grid, first_patch, d, 1));
                add_splat(grid.node_taps.back(), node, pending);
                grid.node_taps.resize(grid.node_taps.size() + grid.taps - 1);
                continue;
            }
            double shares[sphere_patches], sum = 0;
            for (uint f = 0; f < patches; ++f) sum += shares[f] = source_share(grid.patches[first_patch + f], d);
            for (uint f = 0; f < patches; ++f) {
                grid.node_taps.push_back(tap_of(grid, first_patch + f, d, veil_share(grid.patches[first_patch + f], d)));
                if (shares[f] > 0) add_splat(tap_of(grid, first_patch + f, d, shares[f] / sum), node, pending);
            }
        }
        first_patch += patches;
    }
    sort_splats(pending, grid);
}

}  // namespace

GlareGrid make_glare_grid(std::span<const EyeGeometry> views, double texel_px, uint least_texels) {
    GlareGrid grid;
    choose_patches(views, texel_px, least_texels, grid);
    place_nodes(views, grid);
    return grid;
}

}  // namespace entoptic::perception
