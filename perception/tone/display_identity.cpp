#include "perception/gate.h"
#include "perception/tone/display_identity_params.h"
#include "perception/tone/tone.h"

#include "perception/tone/display_identity.comp.h"
#include "perception/tone/display_identity_gate.comp.h"
#include "perception/tone/display_identity_plan.comp.h"

#include <cmath>
#include <cstddef>

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"night_exponent", "1", 0, 1, 0.9f, "choice: night stays darker than day, and can be seen", "scenes darker than the panel are shown at A^(1 - this) cd/m²"},
    {"day_cd_m2", "cd/m²", 1, 100, 23.4f, "choice: 18 % of 130 cd/m²", "where the adapted luminance of scenes brighter than the panel lands"},
    {"day_exponent", "1", 0, 1, 0.1f, "choice: noon stays brighter than morning", "how that grows with the scene"},
    {"knee", "1", 0.3f, 0.99f, 0.8f, "choice: 104 of 130 cd/m²", "share of white from which highlights are compressed"},
    {"smoothing_s", "s", 0, 5, 0.3f, "choice: no step when a lamp comes into view", "time constant of the scene's statistics"},
};
static_assert(sizeof(DisplayIdentityParams) == sizeof(float) * std::size(parameters));

struct PlanPush {
    DisplayIdentityParams params;
    float white_cd_m2, rate;
    uint within_display;
};
struct GatePush {
    uint views, groups;
    float white_cd_m2;
};
struct Push {
    DisplayIdentityParams params;
    uint pixels;
    float white_cd_m2;
};

class DisplayIdentity final : public Model, public PlansTone {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<DisplayIdentity>();
        const auto kernel = [&](gpu::Kernel& into, const char* name, std::span<const std::uint32_t> spirv, std::size_t buffers, std::size_t push) -> Result<void> {
            ENTOPTIC_TRY(made, gpu::Kernel::create(context.device, {name, spirv, std::vector<gpu::BindingKind>(buffers, gpu::BindingKind::storage_buffer),
                                                                   static_cast<std::uint32_t>(push), {}}));
            into = std::move(made);
            return {};
        };
        ENTOPTIC_CHECK(kernel(model->plan_, "tone.display_identity.plan", display_identity_plan_comp_spv, 2, sizeof(PlanPush)));
        ENTOPTIC_CHECK(kernel(model->gate_, "tone.display_identity.gate", display_identity_gate_comp_spv, 3, sizeof(GatePush)));
        ENTOPTIC_CHECK(kernel(model->kernel_, "tone.display_identity", display_identity_comp_spv, 2, sizeof(Push)));
        return model;
    }
    void set_parameters(std::span<const float> v) override { params_ = {v[0], v[1], v[2], v[3], v[4]}; }
    bool obeys_residual_law() const override { return true; }
    Result<void> plan(StageIo& io) override {
        const double dt_s = io.input.dt_s > 0 ? io.input.dt_s : 0, tau_s = static_cast<double>(params_.smoothing_s);
        const float rate = io.input.snap || tau_s <= 0 ? 1.0f : static_cast<float>(-std::expm1(-dt_s / tau_s));
        io.commands.dispatch(plan_, {io.state, io.statistics}, PlanPush{params_, io.display.white_cd_m2, rate, io.input.within_display}, {io.views, 1, 1});
        io.commands.barrier();
        const GatePush push{io.views, gpu::groups_for(io.width * io.height, 256), io.display.white_cd_m2};
        io.commands.dispatch(gate_, {io.state, io.statistics, io.gate}, push, {1, 1, 1});
        return {};
    }
    Result<void> record(StageIo& io) override {
        io.commands.dispatch_indirect(kernel_, {io.scene, io.state}, Push{params_, io.width * io.height, io.display.white_cd_m2}, io.gate,
                                      offsetof(Gate, dispatch));
        return {};
    }

private:
    gpu::Kernel plan_, gate_, kernel_;
    DisplayIdentityParams params_{};
};

}  // namespace

std::unique_ptr<ReferenceModel> make_display_identity_reference();

extern const ModelEntry display_identity_entry;
const ModelEntry display_identity_entry{"tone",     "display_identity",       "What the panel can show, as it is; only what leaves its range is exposed or compressed",
                                        parameters, &DisplayIdentity::create, &make_display_identity_reference};

}  // namespace entoptic::perception
