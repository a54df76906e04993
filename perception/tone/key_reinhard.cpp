#include "perception/tone/key_reinhard_params.h"
#include "perception/tone/tone.h"

#include "perception/tone/key_reinhard.comp.h"
#include "perception/tone/key_reinhard_plan.comp.h"

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"key_scale", "1", 0.05f, 20, 1, "choice: exposure of the user's taste", "multiplies the automatic key: brightness of the picture"},
    {"as_printed", "bool", 0, 1, 0, "Luidolt 2020, section 4.1", "1 multiplies by the adaptation luminance, the wrong sign (trap L1)"},
};
static_assert(sizeof(KeyReinhardParams) == sizeof(float) * std::size(parameters));

struct Push {
    KeyReinhardParams params;
    uint pixels;
    float white_cd_m2, black_cd_m2;
};
struct PlanPush {
    KeyReinhardParams params;
    float white_cd_m2, black_cd_m2;
};

class KeyReinhard final : public Model, public PlansTone {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<KeyReinhard>();
        ENTOPTIC_TRY(kernel, gpu::Kernel::create(context.device, {"tone.key_reinhard", key_reinhard_comp_spv,
                                                                 {gpu::BindingKind::storage_buffer, gpu::BindingKind::storage_buffer}, sizeof(Push), {}}));
        model->kernel_ = std::move(kernel);
        ENTOPTIC_TRY(plan, gpu::Kernel::create(context.device, {"tone.key_reinhard.plan", key_reinhard_plan_comp_spv,
                                                               {gpu::BindingKind::storage_buffer}, sizeof(PlanPush), {}}));
        model->plan_ = std::move(plan);
        return model;
    }
    void set_parameters(std::span<const float> values) override { params_ = {values[0], values[1]}; }
    Result<void> plan(StageIo& io) override {
        io.commands.dispatch(plan_, {io.state}, PlanPush{params_, io.display.white_cd_m2, io.display.black_cd_m2}, {io.views, 1, 1});
        return {};
    }
    Result<void> record(StageIo& io) override {
        const uint pixels = io.width * io.height;
        const Push push{params_, pixels, io.display.white_cd_m2, io.display.black_cd_m2};
        io.commands.dispatch(kernel_, {io.scene, io.state}, push, {gpu::groups_for(pixels, 256), 1, io.views});
        return {};
    }

private:
    gpu::Kernel kernel_, plan_;
    KeyReinhardParams params_{};
};

}  // namespace

std::unique_ptr<ReferenceModel> make_key_reinhard_reference();

extern const ModelEntry key_reinhard_entry;
const ModelEntry key_reinhard_entry{"tone",     "key_reinhard", "Automatic key and Reinhard's curve (Krawczyk 2005)",
                                    parameters, &KeyReinhard::create, &make_key_reinhard_reference};

}  // namespace entoptic::perception
