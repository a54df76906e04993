#include "perception/noise/rod_noise_params.h"
#include "perception/noise/noise.h"

#include "base/noise.h"

#include "perception/noise/rod_noise.comp.h"
#include "perception/noise/rod_noise_gate.comp.h"

#include <cmath>
#include <cstring>

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 3, 1, "choice: taste", "multiplies the noise's contrast; 0 switches it off"},
    {"photographic", "bool", 0, 1, 0, "choice: residual law",
     "1 shows all the noise of an eye in the scene, 0 what the wearer's own eye does not have"},
    {"sp_ratio", "1", 0.1f, 6, 2.4645f, "CIE 191:2010; daylight D65", "scotopic over photopic luminance of the light"},
    {"grain_deg", "deg", 0.1f, 2, 0.5f, "choice: rods are summed over 0.3 to 1 degree",
     "size of a patch of noise and of the rods summed in it"},
    {"integration_s", "s", 0.02f, 1, 0.1f, "choice: rods are summed over 0.1 to 0.2 s",
     "time of the summation, after which the noise is another"},
    {"efficiency", "1", 0.005f, 1, 0.1f, "choice: some 10 % of the quanta at the cornea count",
     "share of the quanta at the cornea that rods absorb"},
};
static_assert(sizeof(RodNoiseParams) == sizeof(float) * std::size(parameters));

struct GatePush {
    RodNoiseParams params;
    uint groups, views;
};
struct Push {
    RodNoiseParams params;
    vec3 gaze;
    float pupil_mm, black_cd_m2, tick_part;
    uint view, tick, seed;
};

class RodNoise final : public Model {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<RodNoise>();
        ENTOPTIC_TRY(pass, (GatedPass::create<GatePush, Push>(context, "noise.rod_noise", rod_noise_gate_comp_spv, rod_noise_comp_spv)));
        model->pass_ = std::move(pass);
        model->seed_ = static_cast<std::uint32_t>(mix64(context.seed));
        return model;
    }
    void set_parameters(std::span<const float> v) override { std::memcpy(&params_, v.data(), sizeof params_); }
    bool is_identity() const override { return params_.strength == 0; }
    bool obeys_residual_law() const override { return params_.photographic < 0.5f; }
    void take_over(gpu::Commands&, Model& from) override { ticks_ = static_cast<RodNoise&>(from).ticks_; }
    Result<void> record(StageIo& io) override {
        if (io.input.dt_s > 0) ticks_ += io.input.dt_s / static_cast<double>(params_.integration_s);
        if (!(ticks_ < 4e9)) ticks_ = 0;  // beyond what the clock's 32 bits hold
        pass_.record_gate(io, GatePush{params_, gpu::groups_for(io.width * io.height, 256), io.views});
        const double tick = std::floor(ticks_);
        for (uint view = 0; view < io.views; ++view) {
            const EyeInput& eye = io.input.eyes[view];
            pass_.record_pass(io, Push{params_, eye.gaze_direction, eye.pupil_diameter_mm, io.display.black_cd_m2,
                                       static_cast<float>(ticks_ - tick), view, static_cast<uint>(tick), seed_});
        }
        return {};
    }

private:
    GatedPass pass_;
    RodNoiseParams params_{};
    double ticks_ = 0;  // of the noise's clock
    std::uint32_t seed_ = 0;
};

}  // namespace

std::unique_ptr<ReferenceModel> make_rod_noise_reference();

extern const ModelEntry rod_noise_entry;
const ModelEntry rod_noise_entry{"noise",    "rod_noise",       "The grain of the dark: single quanta that rods absorb",
                                 parameters, &RodNoise::create, &make_rod_noise_reference};

}  // namespace entoptic::perception
