#include "perception/mesopic/rod_vision.h"

#include <algorithm>

namespace entoptic::perception {
namespace {

constexpr std::size_t parameters_of_a_model = 7;
struct Parameters {
    float values[parameters_of_a_model];
};
struct GatePush {
    Parameters params;
    float black_cd_m2;
    uint node_groups, pixel_groups, views;
};
struct MapPush {
    Parameters params;
    float black_cd_m2;
    uint nodes;
};
struct PixelsPush {
    Parameters params;
    float black_cd_m2;
    LocalMeanGrid grid;
    RodVision rods;
};

}  // namespace

Result<void> RodVisionModel::make(const ModelContext& context, const RodVisionShaders& shaders) {
    const auto kernel = [&](gpu::Kernel& into, const char* part, std::span<const std::uint32_t> spirv, std::size_t bindings,
                            std::size_t push) -> Result<void> {
        const std::vector storage(bindings, gpu::BindingKind::storage_buffer);
        ENTOPTIC_TRY(made, gpu::Kernel::create(context.device, {std::string("mesopic.") + shaders.name + part, spirv, storage,
                                                                static_cast<std::uint32_t>(push), {}}));
        into = std::move(made);
        return {};
    };
    ENTOPTIC_TRY(mean, LocalMean::create(context));
    mean_ = std::move(mean);
    ENTOPTIC_CHECK(kernel(gate_, ".gate", shaders.gate, 3, sizeof(GatePush)));
    ENTOPTIC_CHECK(kernel(map_, ".map", shaders.map, 2, sizeof(MapPush)));
    return kernel(pixels_, "", shaders.pixels, 3, sizeof(PixelsPush));
}

Result<void> RodVisionModel::record(StageIo& io) {
    static_assert(parameters_of_a_model == parameter_count);
    const LocalMeanGrid& grid = mean_->grid();
    const bool local = local_mean_deg_ > 0;
    Parameters params{};
    std::copy_n(parameters_, parameter_count, params.values);
    const float black = io.display.black_cd_m2;
    const GatePush gate{params, black, mean_->node_groups(), gpu::groups_for(io.width * io.height, 256), io.views};
    io.commands.dispatch(gate_, {io.state, io.statistics, io.gate}, gate, {1, 1, 1});
    io.commands.barrier();
    if (local) {
        mean_->record(io, local_mean_deg_, 0);
        const MapPush map{params, black, grid.nodes_x * grid.nodes_y};
        io.commands.dispatch_indirect(map_, {io.state, mean_->means()}, map, io.gate, offsetof(Gate, dispatch));
        io.commands.barrier();
    }
    const PixelsPush pixels{params, black, grid, rods_};
    io.commands.dispatch_indirect(pixels_, {io.state, mean_->means(), io.scene}, pixels, io.gate,
                                  offsetof(Gate, dispatch) + sizeof(GateDispatch));
    return {};
}

namespace {

// Cones' share at one place, by the residual law in words: the share of the scene's eye over that of the wearer's, at most 1.
double share_at(const ReferenceFrame& frame, const RodVisionLaw& law, double y) {
    if (law.photographic) return law.cone_share(y);
    double scene = std::max(y, frame.adaptation_cd_m2);
    double panel = frame.displayed ? frame.displayed(scene) : std::min(scene, static_cast<double>(frame.display.white_cd_m2));
    if (const double black = static_cast<double>(frame.display.black_cd_m2); panel < black) {
        scene *= black / panel;
        panel = black;
    }
    const double in_scene = law.cone_share(scene), at_panel = law.cone_share(panel);
    return in_scene >= at_panel ? 1 : in_scene / at_panel;
}

}  // namespace

void apply_rod_vision(ReferenceFrame& frame, const RodVisionLaw& law) {
    const glm::dvec3 photopic(0.2126, 0.7152, 0.0722), tint = law.tint / glm::dot(photopic, law.tint);
    ImageD mean;
    if (law.local_mean_deg > 0) mean = local_mean_reference(frame.image, frame.geometry, law.local_mean_deg);
    for (int y = 0; y < frame.image.height; ++y)
        for (int x = 0; x < frame.image.width; ++x) {
            double* pixel = &frame.image.at(x, y, 0);
            const glm::dvec3 c(pixel[0], pixel[1], pixel[2]);
            const double cones = glm::dot(photopic, c), rods = law.gain * glm::dot(law.scotopic, c);
            const double local = std::max(law.local_mean_deg > 0 ? mean.at(x, y, 0) : cones, 1e-9);
            const double rho = 1 - law.strength * (1 - share_at(frame, law, local));
            if (!(rho < 1) || !(cones > 0)) continue;
            const double seen = (rho * cones + (1 - rho) * rods) / (rho + (1 - rho) * law.rod_lumen);
            for (int k = 0; k < 3; ++k) pixel[k] = seen * (rho * pixel[k] / cones + (1 - rho) * tint[k]);
        }
}

}  // namespace entoptic::perception
