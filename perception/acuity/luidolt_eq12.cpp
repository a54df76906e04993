#include "perception/acuity/luidolt_eq12_math.glsl"
#include "perception/acuity/acuity.h"
#include "shaders/geometry.glsl"

#include "perception/acuity/luidolt_eq12.comp.h"
#include "perception/acuity/luidolt_eq12_as_printed.comp.h"
#include "perception/acuity/luidolt_eq12_interior.comp.h"
#include "perception/acuity/luidolt_eq12_lightness.comp.h"
#include "perception/acuity/luidolt_eq12_plan.comp.h"

#include <algorithm>
#include <bit>

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 1, 1, "choice: taste", "multiplies the width of the blur; 0 switches it off"},
    {"as_printed", "bool", 0, 1, 0, "Luidolt 2020, section 4.3", "1 blurs in pixels by two 1-D passes in Lab (traps L14, L18)"},
};
static_assert(sizeof(LuidoltEq12Params) == sizeof(float) * std::size(parameters));

struct PlanPush {
    uint tiles_x, tiles_y, views;
    int reach_x, reach_y;
    uint split;
};
struct LightnessPush {
    uint width, height, tiles_x, tiles_y, all_tiles;
};
struct BlurPush {
    LuidoltEq12Params params;
    uint width, height, tiles_x, tiles_y, all_tiles;
};
struct PrintedPush {
    LuidoltEq12Params params;
    uint width, height, tiles_x, tiles_y, all_tiles, vertical;
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

// Lists of tiles and their dispatches, in this order (luidolt_eq12_tiles.glsl).
enum class List : std::size_t { lightness, interior, rim };
constexpr std::size_t offset_of(List list) { return offsetof(Gate, dispatch) + static_cast<std::size_t>(list) * sizeof(GateDispatch); }

// Widest kernel that one invocation still does for a whole column of a tile: beyond, its arrays no longer fit into registers.
constexpr int max_interior_radius = 4;

// Kernel of sigma 1 px as printed: 2·ceil(3 sigma) + 1 taps.
constexpr int printed_radius = 3;

// For every tile of all views: 1 when the tile and `radius` pixels around it lie within the picture and are visible. What a lens shows is
// convex (an intersection of discs), so the corners decide.
std::vector<uint> tiles_inside(const std::vector<EyeGeometry>& views, int radius) {
    std::vector<uint> inside;
    for (const EyeGeometry& g : views)
        for (uint y = 0; y < gpu::groups_for(g.height, tile_height); ++y)
            for (uint x = 0; x < gpu::groups_for(g.width, tile_width); ++x) {
                const glm::dvec2 low = glm::dvec2(x * tile_width, y * tile_height) + (0.5 - radius);
                const glm::dvec2 high = low + glm::dvec2(tile_width, tile_height) + (2.0 * radius - 1);
                const auto visible = [&](double px, double py) { return geometry::geometry_visible(g, {px, py}); };
                const bool in_picture = low.x > 0 && low.y > 0 && high.x < g.width && high.y < g.height;
                inside.push_back(in_picture && visible(low.x, low.y) && visible(low.x, high.y) && visible(high.x, low.y) &&
                                 visible(high.x, high.y));
            }
    return inside;
}

constexpr uint undrawn = std::bit_cast<uint>(-1.0f);

class LuidoltEq12 final : public Model {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<LuidoltEq12>();
        ENTOPTIC_CHECK(model->make_buffers(context));
        ENTOPTIC_CHECK(model->make_kernels(context.device));
        return model;
    }
    void set_parameters(std::span<const float> v) override { params_ = {v[0], v[1]}; }
    bool is_identity() const override { return params_.strength == 0; }

    Result<void> record(StageIo& io) override {
        if (!planes_are_clear_) clear_planes(io.commands);
        const bool as_printed = params_.as_printed > 0.5f;
        const uint all_tiles = io.tiles_x * io.tiles_y * io.views;
        const auto tiles_across = [&](uint tile) { return (radius_ + static_cast<int>(tile) - 1) / static_cast<int>(tile); };
        const PlanPush plan{
            io.tiles_x, io.tiles_y, io.views, tiles_across(tile_width), tiles_across(tile_height), split(as_printed) ? 1u : 0u};
        io.commands.dispatch(plan_, {io.statistics, io.tiles, inside_, lists_, io.gate}, plan, {1, 1, 1});
        io.commands.barrier();
        const LightnessPush lightness{io.width, io.height, io.tiles_x, io.tiles_y, all_tiles};
        io.commands.dispatch_indirect(lightness_, {io.scene, lists_, planes_[0]}, lightness, io.gate, offset_of(List::lightness));
        io.commands.barrier();
        if (as_printed) return record_as_printed(io);
        const BlurPush blur{params_, io.width, io.height, io.tiles_x, io.tiles_y, all_tiles};
        if (split(false))
            io.commands.dispatch_indirect(interior_, {io.scene, lists_, planes_[0], density_}, blur, io.gate, offset_of(List::interior));
        io.commands.dispatch_indirect(blur_, {io.scene, lists_, planes_[0], density_}, blur, io.gate, offset_of(List::rim));
        return {};
    }

private:
    Result<void> make_buffers(const ModelContext& context) {
        const Density density = density_of(context.views);
        const std::size_t border = 2 * static_cast<std::size_t>(luidolt_eq12::max_radius_px);
        const std::size_t bytes =
            (context.views[0].width + border) * (context.views[0].height + border) * context.views.size() * sizeof(float);
        for (gpu::Buffer& plane : planes_) {
            ENTOPTIC_TRY(made, gpu::Buffer::create(context.device, bytes, gpu::BufferKind::device, "acuity lightness"));
            plane = std::move(made);
        }
        ENTOPTIC_TRY(corners, gpu::Buffer::create(context.device, density.at_corners.size() * sizeof(float), gpu::BufferKind::upload,
                                                  "acuity density"));
        density_ = std::move(corners);
        std::ranges::copy(density.at_corners, density_.as<float>().begin());
        radius_ = std::max(luidolt_eq12::kernel_radius(luidolt_eq12::blur_sigma_px({1, 0}, 0, density.largest)), printed_radius);
        const std::vector<uint> inside = tiles_inside(context.views, radius_);
        ENTOPTIC_TRY(flags,
                     gpu::Buffer::create(context.device, inside.size() * sizeof(uint), gpu::BufferKind::upload, "acuity tiles inside"));
        inside_ = std::move(flags);
        std::ranges::copy(inside, inside_.as<uint>().begin());
        ENTOPTIC_TRY(lists, gpu::Buffer::create(context.device, (3 * inside.size() + 3) * sizeof(uint), gpu::BufferKind::device,
                                                "acuity tile lists"));
        lists_ = std::move(lists);
        return {};
    }
    Result<void> make_kernels(gpu::Device& device) {
        const auto storage = gpu::BindingKind::storage_buffer;
        const auto radius = static_cast<std::uint32_t>(radius_);
        const auto make = [&](gpu::Kernel& kernel, gpu::KernelInfo info) -> Result<void> {
            ENTOPTIC_TRY(made, gpu::Kernel::create(device, info));
            kernel = std::move(made);
            return {};
        };
        ENTOPTIC_CHECK(
            make(plan_, {"acuity.luidolt_eq12.plan", luidolt_eq12_plan_comp_spv, std::vector(5, storage), sizeof(PlanPush), {}}));
        ENTOPTIC_CHECK(make(
            lightness_,
            {"acuity.luidolt_eq12.lightness", luidolt_eq12_lightness_comp_spv, {storage, storage, storage}, sizeof(LightnessPush), {}}));
        const std::vector blur_bindings(4, storage);
        if (split(false))
            ENTOPTIC_CHECK(make(
                interior_, {"acuity.luidolt_eq12.interior", luidolt_eq12_interior_comp_spv, blur_bindings, sizeof(BlurPush), {radius}}));
        ENTOPTIC_CHECK(make(blur_, {"acuity.luidolt_eq12", luidolt_eq12_comp_spv, blur_bindings, sizeof(BlurPush), {radius}}));
        return make(printed_, {"acuity.luidolt_eq12.as_printed", luidolt_eq12_as_printed_comp_spv, blur_bindings, sizeof(PrintedPush), {}});
    }
    bool split(bool as_printed) const { return !as_printed && radius_ <= max_interior_radius; }
    void clear_planes(gpu::Commands& commands) {
        for (const gpu::Buffer& plane : planes_) commands.fill(plane, undrawn);
        commands.barrier();
        planes_are_clear_ = true;
    }
    Result<void> record_as_printed(StageIo& io) {
        const auto pass = [&](const gpu::Buffer& from, const gpu::Buffer& to, uint vertical, List list) {
            const PrintedPush push{params_, io.width, io.height, io.tiles_x, io.tiles_y, io.tiles_x * io.tiles_y * io.views, vertical};
            io.commands.dispatch_indirect(printed_, {io.scene, lists_, from, to}, push, io.gate, offset_of(list));
        };
        pass(planes_[0], planes_[1], 0, List::lightness);  // the columns of the second pass reach into tiles that are not dark
        io.commands.barrier();
        pass(planes_[1], planes_[0], 1, List::rim);
        return {};
    }

    gpu::Kernel plan_, lightness_, interior_, blur_, printed_;
    gpu::Buffer planes_[2];  // lightness, with a border; the second for the printed first pass
    gpu::Buffer density_;
    gpu::Buffer inside_;  // a flag a tile
    gpu::Buffer lists_;   // of tiles, and their lengths
    bool planes_are_clear_ = false;
    int radius_ = 0;  // of the widest kernel
    LuidoltEq12Params params_{};
};

}  // namespace

std::unique_ptr<ReferenceModel> make_luidolt_eq12_reference();

extern const ModelEntry luidolt_eq12_entry;
const ModelEntry luidolt_eq12_entry{
    "acuity",   "luidolt_eq12",       "Blur of dark pixels' lightness (Luidolt 2020, equation 12, in visual angle)",
    parameters, &LuidoltEq12::create, &make_luidolt_eq12_reference};

}  // namespace entoptic::perception
