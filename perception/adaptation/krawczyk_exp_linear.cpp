#include "perception/adaptation/krawczyk_exp_linear_math.glsl"
#include "perception/adaptation/adaptation.h"

#include "perception/adaptation/krawczyk_exp_linear.comp.h"

#include <cmath>

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"sigma_gaze_deg", "deg", 0.5f, 30, 2.5f, "choice: Luidolt 2020, section 4.1 gives no width",
     "how far around the gaze light drives adaptation"},
    {"wide_share", "1", 0, 0.3f, 0.08f, "Moon and Spencer 1945", "share of the whole field's mean, which veils the fovea"},
    {"tau_rod_s", "s", 0.05f, 5, 0.4f, "Luidolt 2020, equation 3", "time constant of rod vision"},
    {"tau_cone_s", "s", 0.02f, 2, 0.1f, "Luidolt 2020, equation 3", "time constant of cone vision"},
    {"speed", "1", 0.05f, 20, 1, "choice: demonstrations", "multiplies time"},
    {"floor_cd_m2", "cd/m²", 1e-6f, 100, 1e-6f, "Jacobs 2015 (100 in an office); 1e-6 is none", "the eye never adapts below this"},
    {"clip_over_median", "1", 10, 1e8f, 1e4f, "choice: a sun of 7x7 pixels must not own the mean",
     "brightest tile over the median tile that counts"},
    {"as_printed", "bool", 0, 1, 0, "Luidolt 2020, section 4.1", "1 does not normalise the gaze weights (trap L2)"},
};
static_assert(sizeof(KrawczykExpLinearParams) == sizeof(float) * std::size(parameters));

constexpr float lid_counts_as_closed = 0.5f;
// Pictures of at most this many pixels (128x128, the paper's own reduction) are weighted pixel by pixel: their tiles of 32x8 pixels would be
// wider than the Gaussian around the gaze.
constexpr std::uint32_t most_single_pixels = 128 * 128;

struct Push {
    KrawczykExpLinearParams params;
    vec3 gaze;
    float dt_s;
    uint view, tiles_x, tiles_y, snap, lid_closed, by_pixel;
};

class KrawczykExpLinear final : public Model {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<KrawczykExpLinear>();
        const auto storage = gpu::BindingKind::storage_buffer;
        ENTOPTIC_TRY(
            kernel,
            gpu::Kernel::create(
                context.device,
                {"adaptation.krawczyk_exp_linear", krawczyk_exp_linear_comp_spv, {storage, storage, storage, storage, storage, storage}, sizeof(Push), {}}));
        model->kernel_ = std::move(kernel);
        model->views_ = context.views;
        return model;
    }
    void set_parameters(std::span<const float> v) override { params_ = {v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]}; }
    Result<void> record(StageIo& io) override {
        // No step for dt <= 0 and NaN. An infinite one would be 0 times infinity in the series.
        const float dt_s = io.input.dt_s > 0 ? static_cast<float>(std::min(io.input.dt_s, 1e6)) : 0.0f;
        for (std::uint32_t view = 0; view < io.views; ++view) {
            const EyeInput& eye = io.input.eyes[view];
            const vec3 gaze(krawczyk_exp_linear::gaze_in_view(views_[view], glm::dvec3(eye.gaze_direction)));
            const bool closed = !(eye.eyelid_open >= lid_counts_as_closed);
            io.commands.dispatch(kernel_, {io.tiles, io.geometry, io.statistics, io.state, io.scene, io.solid_angle},
                                 Push{params_, gaze, dt_s, view, io.tiles_x, io.tiles_y, io.input.snap ? 1u : 0u, closed ? 1u : 0u,
                                      io.width * io.height <= most_single_pixels ? 1u : 0u},
                                 {1, 1, 1});
        }
        return {};
    }

private:
    gpu::Kernel kernel_;
    KrawczykExpLinearParams params_{};
    std::vector<EyeGeometry> views_;
};

}  // namespace

std::unique_ptr<ReferenceModel> make_krawczyk_exp_linear_reference();

extern const ModelEntry krawczyk_exp_linear_entry;
const ModelEntry krawczyk_exp_linear_entry{
    "adaptation", "krawczyk_exp_linear",      "Exponential adaptation to the luminance around the gaze (Krawczyk 2005)",
    parameters,   &KrawczykExpLinear::create, &make_krawczyk_exp_linear_reference};

}  // namespace entoptic::perception
