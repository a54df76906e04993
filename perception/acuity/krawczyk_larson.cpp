#include "perception/acuity/krawczyk_larson_math.glsl"
#include "perception/acuity/lightness_planes.h"

#include "perception/acuity/krawczyk_larson.comp.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 1, 1, "choice: taste", "multiplies the width of the blur; 0 switches it off"},
};
static_assert(sizeof(KrawczykLarsonParams) == sizeof(float) * std::size(parameters));

struct BlurPush {
    KrawczykLarsonParams params;
    uint width, height, tiles_x, tiles_y, all_tiles;
};

// Luminance (cd/m²) from which no pixel of this many per degree is blurred: where sigma is that of a pixel's box.
double sharp_luminance(double ppd) {
    double dark = 1e-6, bright = 1e8;
    while (bright / dark > 1.001) {
        const double middle = std::sqrt(dark * bright);
        (krawczyk_larson::acuity_sigma_px({1}, luidolt_eq12::lightness(middle), ppd) > 0 ? dark : bright) = middle;
    }
    return bright;
}

class KrawczykLarson final : public Model {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<KrawczykLarson>();
        const double ppd = largest_ppd(context.views);
        const double widest = krawczyk_larson::acuity_sigma_px({1}, 0, ppd);
        ENTOPTIC_TRY(planes, LightnessPlanes::create(context, std::min(luidolt_eq12::kernel_radius(widest), luidolt_eq12::max_radius_px)));
        ENTOPTIC_TRY(blur, gpu::Kernel::create(context.device, {"acuity.krawczyk_larson", krawczyk_larson_comp_spv,
                                                               std::vector(4, gpu::BindingKind::storage_buffer), sizeof(BlurPush), {}}));
        model->planes_ = std::move(planes);
        model->blur_ = std::move(blur);
        model->dark_cd_m2_ = static_cast<float>(2 * sharp_luminance(ppd));   // 2: glare may take a little light after the statistics
        return model;
    }
    void set_parameters(std::span<const float> v) override { params_ = {v[0]}; }
    bool is_identity() const override { return params_.strength == 0; }
    Result<void> record(StageIo& io) override {
        planes_.record(io, dark_cd_m2_, false);
        const BlurPush push{params_, io.width, io.height, io.tiles_x, io.tiles_y, io.tiles_x * io.tiles_y * io.views};
        io.commands.dispatch_indirect(blur_, {io.scene, planes_.lists, planes_.lightness[0], planes_.density}, push, io.gate,
                                      LightnessPlanes::dispatch(LightnessPlanes::List::rim));
        return {};
    }

private:
    LightnessPlanes planes_;
    gpu::Kernel blur_;
    float dark_cd_m2_ = 0;
    KrawczykLarsonParams params_{};
};

}  // namespace

std::unique_ptr<ReferenceModel> make_krawczyk_larson_reference();

extern const ModelEntry krawczyk_larson_entry;
const ModelEntry krawczyk_larson_entry{"acuity",   "krawczyk_larson",       "Blur of each pixel by the acuity at its own luminance (Krawczyk 2005, Larson 1997)",
                                       parameters, &KrawczykLarson::create, &make_krawczyk_larson_reference};

}  // namespace entoptic::perception
