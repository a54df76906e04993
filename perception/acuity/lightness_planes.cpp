#include "perception/acuity/lightness_planes.h"

#include "perception/acuity/luidolt_eq12_math.glsl"
#include "shaders/geometry.glsl"

#include "perception/acuity/luidolt_eq12_lightness.comp.h"
#include "perception/acuity/luidolt_eq12_plan.comp.h"

#include <algorithm>
#include <bit>

namespace entoptic::perception {
namespace {

struct PlanPush {
    uint tiles_x, tiles_y, views;
    int reach_x, reach_y;
    uint split;
    float dark_cd_m2;
};
struct LightnessPush {
    uint width, height, tiles_x, tiles_y, all_tiles;
};

// Pixels per degree at the corners of all tiles, of all views, and the largest of them where something is visible.
struct Density {
    std::vector<float> at_corners;
    double largest = 0;
};

Density density_of(const std::vector<EyeGeometry>& views) {
    Density density;
    for (const EyeGeometry& g : views)
        for (uint y = 0; y <= gpu::groups_for(g.height, tile_height); ++y)
            for (uint x = 0; x <= gpu::groups_for(g.width, tile_width); ++x) {
                const glm::dvec2 px(x * tile_width, y * tile_height);
                // Where the lens shows nothing the formula may be anything; 1e4 pixels per degree is above every display.
                const double ppd = std::clamp(geometry::geometry_ppd(g, px), 0.0, 1e4);
                density.at_corners.push_back(static_cast<float>(ppd));
                if (geometry::geometry_visible(g, px)) density.largest = std::max(density.largest, ppd);
            }
    return density;
}

// For every tile of all views: 1 when the tile and `radius` pixels around it lie within the picture and are visible. What a lens shows is
// convex (an intersection of discs), so the corners decide. What a foveated image shows changes with the gaze: none of its tiles is.
std::vector<uint> tiles_inside(const std::vector<EyeGeometry>& views, int radius) {
    std::vector<uint> inside;
    for (const EyeGeometry& g : views)
        for (uint y = 0; y < gpu::groups_for(g.height, tile_height); ++y)
            for (uint x = 0; x < gpu::groups_for(g.width, tile_width); ++x) {
                const glm::dvec2 low = glm::dvec2(x * tile_width, y * tile_height) + (0.5 - radius);
                const glm::dvec2 high = low + glm::dvec2(tile_width, tile_height) + (2.0 * radius - 1);
                const auto visible = [&](double px, double py) { return geometry::geometry_visible(g, {px, py}); };
                const bool in_picture = low.x > 0 && low.y > 0 && high.x < g.width && high.y < g.height;
                inside.push_back(g.kind != geometry_foveated && in_picture && visible(low.x, low.y) && visible(low.x, high.y) && visible(high.x, low.y) &&
                                 visible(high.x, high.y));
            }
    return inside;
}

constexpr uint undrawn = std::bit_cast<uint>(-1.0f);

}  // namespace

double largest_ppd(const std::vector<EyeGeometry>& views) { return density_of(views).largest; }

Result<LightnessPlanes> LightnessPlanes::create(const ModelContext& context, int radius) {
    LightnessPlanes planes;
    planes.radius = radius;
    const auto buffer = [&](gpu::Buffer& into, std::size_t bytes, gpu::BufferKind kind, const char* name) -> Result<void> {
        ENTOPTIC_TRY(made, gpu::Buffer::create(context.device, bytes, kind, name));
        into = std::move(made);
        return {};
    };
    const std::size_t border = 2 * static_cast<std::size_t>(luidolt_eq12::max_radius_px);
    const std::size_t bytes = (context.views[0].width + border) * (context.views[0].height + border) * context.views.size() * sizeof(float);
    for (gpu::Buffer& plane : planes.lightness) ENTOPTIC_CHECK(buffer(plane, bytes, gpu::BufferKind::device, "acuity lightness"));
    const Density density = density_of(context.views);
    ENTOPTIC_CHECK(buffer(planes.density, density.at_corners.size() * sizeof(float), gpu::BufferKind::upload, "acuity density"));
    std::ranges::copy(density.at_corners, planes.density.as<float>().begin());
    const std::vector<uint> inside = tiles_inside(context.views, radius);
    ENTOPTIC_CHECK(buffer(planes.inside, inside.size() * sizeof(uint), gpu::BufferKind::upload, "acuity tiles inside"));
    std::ranges::copy(inside, planes.inside.as<uint>().begin());
    ENTOPTIC_CHECK(buffer(planes.lists, (3 * inside.size() + 3) * sizeof(uint), gpu::BufferKind::device, "acuity tile lists"));
    const auto kernel = [&](gpu::Kernel& into, const char* name, std::span<const std::uint32_t> spirv, std::size_t bindings, std::size_t push) -> Result<void> {
        ENTOPTIC_TRY(made, gpu::Kernel::create(context.device, {name, spirv, std::vector(bindings, gpu::BindingKind::storage_buffer),
                                                                static_cast<std::uint32_t>(push), {}}));
        into = std::move(made);
        return {};
    };
    ENTOPTIC_CHECK(kernel(planes.plan, "acuity.plan", luidolt_eq12_plan_comp_spv, 5, sizeof(PlanPush)));
    ENTOPTIC_CHECK(kernel(planes.fill, "acuity.lightness", luidolt_eq12_lightness_comp_spv, 3, sizeof(LightnessPush)));
    return planes;
}

void LightnessPlanes::record(StageIo& io, float dark_cd_m2, bool split) {
    if (!clear) {
        for (const gpu::Buffer& plane : lightness) io.commands.fill(plane, undrawn);
        io.commands.barrier();
        clear = true;
    }
    const auto tiles_across = [&](uint tile) { return (radius + static_cast<int>(tile) - 1) / static_cast<int>(tile); };
    const PlanPush push{io.tiles_x, io.tiles_y, io.views, tiles_across(tile_width), tiles_across(tile_height), split ? 1u : 0u, dark_cd_m2};
    io.commands.dispatch(plan, {io.statistics, io.tiles, inside, lists, io.gate}, push, {1, 1, 1});
    io.commands.barrier();
    const LightnessPush size{io.width, io.height, io.tiles_x, io.tiles_y, io.tiles_x * io.tiles_y * io.views};
    io.commands.dispatch_indirect(fill, {io.scene, lists, lightness[0]}, size, io.gate, dispatch(List::lightness));
    io.commands.barrier();
}

}  // namespace entoptic::perception
