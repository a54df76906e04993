#include "perception/local_mean.h"

#include "perception/gate.h"
#include "perception/local_mean_math.glsl"
#include "shaders/colour_math.glsl"
#include "shaders/geometry.glsl"

#include "perception/local_mean_cells.comp.h"
#include "perception/local_mean_columns.comp.h"
#include "perception/local_mean_rows.comp.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace entoptic::perception {
namespace {

struct CellsPush {
    LocalMeanGrid grid;
};
struct WindowPush {
    LocalMeanGrid grid;
    float diameter_deg;
};

// choice: a third of a degree, in whole powers of two of pixels: several nodes a window, few enough to cost nothing.
constexpr double cell_deg = 0.35;

LocalMeanGrid grid_of(const EyeGeometry& g) {
    const double ppd = geometry::geometry_ppd(g, glm::dvec2(g.width, g.height) * 0.5);
    const uint cell = std::bit_floor(static_cast<uint>(std::clamp(cell_deg * ppd, 1.0, 64.0)));
    return {g.width, g.height, cell, gpu::groups_for(g.width, cell), gpu::groups_for(g.height, cell), static_cast<float>(ppd)};
}

}  // namespace

Result<LocalMean> LocalMean::create(const ModelContext& context) {
    LocalMean mean;
    mean.grid_ = grid_of(context.views[0]);
    const std::size_t nodes = std::size_t(mean.grid_.nodes_x) * mean.grid_.nodes_y * context.views.size();
    const auto buffer = [&](gpu::Buffer& into, std::size_t bytes, const char* name) -> Result<void> {
        ENTOPTIC_TRY(made, gpu::Buffer::create(context.device, nodes * bytes, gpu::BufferKind::device, name));
        into = std::move(made);
        return {};
    };
    ENTOPTIC_CHECK(buffer(mean.cells_, sizeof(LocalCell), "local mean cells"));
    ENTOPTIC_CHECK(buffer(mean.rows_, sizeof(vec2), "local mean rows"));
    ENTOPTIC_CHECK(buffer(mean.means_, sizeof(float), "local means"));
    const auto kernel = [&](gpu::Kernel& into, const char* name, std::span<const std::uint32_t> spirv, std::size_t bindings,
                            std::size_t push) -> Result<void> {
        const std::vector storage(bindings, gpu::BindingKind::storage_buffer);
        ENTOPTIC_TRY(made, gpu::Kernel::create(context.device, {name, spirv, storage, static_cast<std::uint32_t>(push), {}}));
        into = std::move(made);
        return {};
    };
    ENTOPTIC_CHECK(kernel(mean.sum_cells_, "local_mean.cells", local_mean_cells_comp_spv, 3, sizeof(CellsPush)));
    ENTOPTIC_CHECK(kernel(mean.sum_rows_, "local_mean.rows", local_mean_rows_comp_spv, 2, sizeof(WindowPush)));
    ENTOPTIC_CHECK(kernel(mean.sum_columns_, "local_mean.columns", local_mean_columns_comp_spv, 3, sizeof(WindowPush)));
    return mean;
}

void LocalMean::record(StageIo& io, float diameter_deg, std::size_t nodes_dispatch) {
    const std::size_t groups = offsetof(Gate, dispatch) + nodes_dispatch * sizeof(GateDispatch);
    const WindowPush push{grid_, diameter_deg};
    io.commands.dispatch_indirect(sum_cells_, {io.scene, io.solid_angle, cells_}, CellsPush{grid_}, io.gate, groups);
    io.commands.barrier();
    io.commands.dispatch_indirect(sum_rows_, {cells_, rows_}, push, io.gate, groups);
    io.commands.barrier();
    io.commands.dispatch_indirect(sum_columns_, {cells_, rows_, means_}, push, io.gate, groups);
    io.commands.barrier();
}

ImageD local_mean_reference(const ImageD& image, const EyeGeometry& g, double diameter_deg) {
    const double sigma = diameter_deg / 4 * 3.14159265358979323846 / 180;
    const auto index = [&](int x, int y) { return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x); };
    std::vector<glm::dvec3> direction(index(0, image.height));
    std::vector<double> light(direction.size()), sr(direction.size());
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const glm::dvec2 px(x + 0.5, y + 0.5);
            direction[index(x, y)] = geometry::geometry_direction(g, px);
            sr[index(x, y)] = geometry::geometry_visible(g, px) ? geometry::geometry_solid_angle(g, px) : 0;
            light[index(x, y)] = 0.2126 * image.at(x, y, 0) + 0.7152 * image.at(x, y, 1) + 0.0722 * image.at(x, y, 2);
        }
    ImageD mean(image.width, image.height, 1);
    for (int y0 = 0; y0 < image.height; ++y0)
        for (int x0 = 0; x0 < image.width; ++x0) {
            const glm::dvec3 here = direction[index(x0, y0)];
            // Half a pixel's step on each axis tells how many pixels 5 sigma are.
            const auto reach = [&](double dx, double dy) {
                const glm::dvec2 px(x0 + 0.5, y0 + 0.5);
                const double step = glm::length(geometry::geometry_direction(g, px + glm::dvec2(dx, dy)) - here);
                return static_cast<int>(std::ceil(std::min(2.7 * sigma / std::max(step, 1e-9), 4096.0)));
            };
            const int across = reach(0.5, 0), down = reach(0, 0.5);
            double sum = 0, weights = 0;
            for (int y = std::max(y0 - down, 0); y <= std::min(y0 + down, image.height - 1); ++y)
                for (int x = std::max(x0 - across, 0); x <= std::min(x0 + across, image.width - 1); ++x) {
                    const glm::dvec3 apart = direction[index(x, y)] - here;
                    const double angle2 = glm::dot(apart, apart);
                    if (angle2 > 25 * sigma * sigma) continue;
                    const double w = sr[index(x, y)] * std::exp(-0.5 * angle2 / (sigma * sigma));
                    sum += w * light[index(x, y)];
                    weights += w;
                }
            mean.at(x0, y0, 0) = weights > 0 ? sum / weights : 0;
        }
    return mean;
}

}  // namespace entoptic::perception
