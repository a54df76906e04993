#include "perception/acuity/local_blur.h"

#include "base/noise.h"
#include "perception/acuity/lightness_planes.h"

#include "perception/acuity/local_blur.comp.h"
#include "perception/acuity/local_blur_plan.comp.h"
#include "perception/acuity/local_blur_tiles.comp.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

// Of any model: the shaders read as many as their struct has.
struct Parameters {
    float values[8];
};
struct GatePush {
    float black_cd_m2, largest_ppd;
    uint node_groups, tile_groups, views;
    Parameters params;
};
struct MapPush {
    LocalMeanGrid grid;
    vec3 gaze;
    float black_cd_m2, tick_part;
    uint view, tick, seed;
    Parameters params;
};
struct TilesPush {
    LocalMeanGrid grid;
    uint tiles_x, tiles_y, views;
};
struct PlanPush {
    uint tiles_x, tiles_y, views;
};
struct BlurPush {
    LocalMeanGrid grid;
    uint tiles_x, tiles_y, all_tiles;
};

// The dispatches of local_blur_gate.glsl.
constexpr std::size_t dispatch_at(std::size_t index) { return offsetof(Gate, dispatch) + index * sizeof(GateDispatch); }

}  // namespace

Result<void> LocalBlurModel::make(const ModelContext& context, const LocalBlurShaders& shaders) {
    const EyeGeometry& first = context.views[0];
    const std::size_t views = context.views.size(), pixels = std::size_t(first.width) * first.height * views;
    const std::size_t all_tiles = std::size_t(gpu::groups_for(first.width, tile_width)) * gpu::groups_for(first.height, tile_height) * views;
    const auto buffer = [&](gpu::Buffer& into, std::size_t bytes, const char* name) -> Result<void> {
        ENTOPTIC_TRY(made, gpu::Buffer::create(context.device, bytes, gpu::BufferKind::device, name));
        into = std::move(made);
        return {};
    };
    ENTOPTIC_CHECK(buffer(widest_, all_tiles * sizeof(float), "acuity widest blurs"));
    ENTOPTIC_CHECK(buffer(lists_, (3 * all_tiles + 3) * sizeof(uint), "acuity tile lists"));
    ENTOPTIC_CHECK(buffer(plane_, pixels * sizeof(vec4), "acuity rows"));
    const auto kernel = [&](gpu::Kernel& into, const char* part, std::span<const std::uint32_t> spirv, std::size_t bindings, std::size_t push,
                            std::vector<std::uint32_t> constants = {}) -> Result<void> {
        const std::vector storage(bindings, gpu::BindingKind::storage_buffer);
        ENTOPTIC_TRY(made, gpu::Kernel::create(context.device, {std::string("acuity.") + shaders.name + part, spirv, storage,
                                                                static_cast<std::uint32_t>(push), std::move(constants)}));
        into = std::move(made);
        return {};
    };
    ENTOPTIC_TRY(mean, LocalMean::create(context));
    mean_ = std::move(mean);
    largest_ppd_ = static_cast<float>(largest_ppd(context.views));
    seed_ = static_cast<std::uint32_t>(mix64(context.seed));
    ENTOPTIC_CHECK(kernel(gate_, ".gate", shaders.gate, 3, sizeof(GatePush)));
    ENTOPTIC_CHECK(kernel(map_, ".map", shaders.map, 4, sizeof(MapPush)));
    ENTOPTIC_CHECK(kernel(tiles_, ".tiles", local_blur_tiles_comp_spv, 3, sizeof(TilesPush)));
    ENTOPTIC_CHECK(kernel(plan_, ".plan", local_blur_plan_comp_spv, 3, sizeof(PlanPush)));
    ENTOPTIC_CHECK(kernel(rows_, ".rows", local_blur_comp_spv, 4, sizeof(BlurPush), {0}));
    return kernel(columns_, ".columns", local_blur_comp_spv, 4, sizeof(BlurPush), {1});
}

Result<void> LocalBlurModel::record(StageIo& io) {
    if (io.input.dt_s > 0) ticks_ += io.input.dt_s * static_cast<double>(rate_hz_);
    Parameters params{};
    std::copy_n(parameters_, parameter_count, params.values);
    const float black = io.display.black_cd_m2;
    const uint all_tiles = io.tiles_x * io.tiles_y * io.views;
    const GatePush gate{black, largest_ppd_, mean_->node_groups(), gpu::groups_for(all_tiles, 64), io.views, params};
    io.commands.dispatch(gate_, {io.state, io.statistics, io.gate}, gate, {1, 1, 1});
    io.commands.barrier();
    mean_->record(io, local_mean_deg_, 0);
    const double tick = std::floor(ticks_);
    for (uint view = 0; view < io.views; ++view) {
        const MapPush map{mean_->grid(), io.input.eyes[view].gaze_direction, black, static_cast<float>(ticks_ - tick), view,
                          static_cast<uint>(static_cast<std::uint64_t>(tick)), seed_, params};
        io.commands.dispatch_indirect(map_, {io.state, mean_->means(), mean_->cells(), io.geometry}, map, io.gate, dispatch_at(1));
    }
    io.commands.barrier();
    record_blur(io);
    return {};
}

void LocalBlurModel::record_blur(StageIo& io) {
    const TilesPush tiles{mean_->grid(), io.tiles_x, io.tiles_y, io.views};
    io.commands.dispatch_indirect(tiles_, {mean_->means(), io.tiles, widest_}, tiles, io.gate, dispatch_at(2));
    io.commands.barrier();
    io.commands.dispatch_indirect(plan_, {widest_, lists_, io.gate}, PlanPush{io.tiles_x, io.tiles_y, io.views}, io.gate, dispatch_at(3));
    io.commands.barrier();
    const BlurPush blur{mean_->grid(), io.tiles_x, io.tiles_y, io.tiles_x * io.tiles_y * io.views};
    io.commands.dispatch_indirect(rows_, {io.scene, lists_, mean_->means(), plane_}, blur, io.gate, dispatch_at(4));
    io.commands.barrier();
    io.commands.dispatch_indirect(columns_, {plane_, lists_, mean_->means(), io.scene}, blur, io.gate, dispatch_at(5));
}

}  // namespace entoptic::perception
