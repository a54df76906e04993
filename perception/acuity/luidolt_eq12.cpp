#include "perception/acuity/luidolt_eq12_math.glsl"
#include "perception/acuity/lightness_planes.h"

#include "perception/acuity/luidolt_eq12.comp.h"
#include "perception/acuity/luidolt_eq12_as_printed.comp.h"
#include "perception/acuity/luidolt_eq12_interior.comp.h"

#include <algorithm>

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 1, 1, "choice: taste", "multiplies the width of the blur; 0 switches it off"},
    {"as_printed", "bool", 0, 1, 0, "Luidolt 2020, section 4.3", "1 blurs in pixels by two 1-D passes in Lab (traps L14, L18)"},
};
static_assert(sizeof(LuidoltEq12Params) == sizeof(float) * std::size(parameters));

struct BlurPush {
    LuidoltEq12Params params;
    uint width, height, tiles_x, tiles_y, all_tiles;
};
struct PrintedPush {
    LuidoltEq12Params params;
    uint width, height, tiles_x, tiles_y, all_tiles, vertical;
};

// Widest kernel that one invocation still does for a whole column of a tile: beyond, its arrays no longer fit into registers.
constexpr int max_interior_radius = 4;

// Kernel of sigma 1 px as printed: 2·ceil(3 sigma) + 1 taps.
constexpr int printed_radius = 3;

class LuidoltEq12 final : public Model {
    using List = LightnessPlanes::List;

public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<LuidoltEq12>();
        const double widest = luidolt_eq12::blur_sigma_px({1, 0}, 0, largest_ppd(context.views));
        model->radius_ = std::max(luidolt_eq12::kernel_radius(widest), printed_radius);
        ENTOPTIC_TRY(planes, LightnessPlanes::create(context, model->radius_));
        model->planes_ = std::move(planes);
        ENTOPTIC_CHECK(model->make_kernels(context.device));
        return model;
    }
    void set_parameters(std::span<const float> v) override { params_ = {v[0], v[1]}; }
    bool is_identity() const override { return params_.strength == 0; }

    Result<void> record(StageIo& io) override {
        const bool as_printed = params_.as_printed > 0.5f;
        const uint all_tiles = io.tiles_x * io.tiles_y * io.views;
        // Tile statistics are of the warp. Glare ran in between: it may take light from a pixel, its halo's share, which is far below the
        // half that is allowed for here.
        planes_.record(io, 2 * luidolt_eq12::sharp_cd_m2, split(as_printed));
        if (as_printed) return record_as_printed(io);
        const BlurPush blur{params_, io.width, io.height, io.tiles_x, io.tiles_y, all_tiles};
        if (split(false))
            io.commands.dispatch_indirect(interior_, {io.scene, planes_.lists, planes_.lightness[0], planes_.density}, blur, io.gate, LightnessPlanes::dispatch(List::interior));
        io.commands.dispatch_indirect(blur_, {io.scene, planes_.lists, planes_.lightness[0], planes_.density}, blur, io.gate, LightnessPlanes::dispatch(List::rim));
        return {};
    }

private:
    Result<void> make_kernels(gpu::Device& device) {
        const auto storage = gpu::BindingKind::storage_buffer;
        const auto radius = static_cast<std::uint32_t>(radius_);
        const auto make = [&](gpu::Kernel& kernel, gpu::KernelInfo info) -> Result<void> {
            ENTOPTIC_TRY(made, gpu::Kernel::create(device, info));
            kernel = std::move(made);
            return {};
        };
        const std::vector blur_bindings(4, storage);
        if (split(false))
            ENTOPTIC_CHECK(make(
                interior_, {"acuity.luidolt_eq12.interior", luidolt_eq12_interior_comp_spv, blur_bindings, sizeof(BlurPush), {radius}}));
        ENTOPTIC_CHECK(make(blur_, {"acuity.luidolt_eq12", luidolt_eq12_comp_spv, blur_bindings, sizeof(BlurPush), {radius}}));
        return make(printed_, {"acuity.luidolt_eq12.as_printed", luidolt_eq12_as_printed_comp_spv, blur_bindings, sizeof(PrintedPush), {}});
    }
    bool split(bool as_printed) const { return !as_printed && radius_ <= max_interior_radius; }
    Result<void> record_as_printed(StageIo& io) {
        const auto pass = [&](const gpu::Buffer& from, const gpu::Buffer& to, uint vertical, List list) {
            const PrintedPush push{params_, io.width, io.height, io.tiles_x, io.tiles_y, io.tiles_x * io.tiles_y * io.views, vertical};
            io.commands.dispatch_indirect(printed_, {io.scene, planes_.lists, from, to}, push, io.gate, LightnessPlanes::dispatch(list));
        };
        pass(planes_.lightness[0], planes_.lightness[1], 0, List::lightness);  // the columns of the second pass reach into tiles that are not dark
        io.commands.barrier();
        pass(planes_.lightness[1], planes_.lightness[0], 1, List::rim);
        return {};
    }

    gpu::Kernel interior_, blur_, printed_;
    LightnessPlanes planes_;  // the second plane for the printed first pass
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
