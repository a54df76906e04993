#include "perception/tone/naka_rushton_params.h"
#include "perception/tone/tone.h"

#include "perception/tone/naka_rushton.comp.h"
#include "perception/tone/naka_rushton_plan.comp.h"

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"exponent", "1", 0.5f, 1, 0.7f, "Jacobs 2015, equation 1", "steepness n of the response"},
    {"plateau_scale", "1", 0.5f, 2, 1, "choice: brightness of the picture", "multiplies the response to the adapted luminance"},
    {"plateau", "1", 0, 0.999f, 0, "Jacobs 2015, equation 2, which gives no value", "above 0: that response is this constant"},
    {"display_adaptation_cd_m2", "cd/m²", 0, 130, 0, "Tumblin 1999; 0 is Jacobs 2015", "above 0: what an eye adapted to this would answer is shown, 5 to 25"},
};
static_assert(sizeof(NakaRushtonParams) == sizeof(float) * std::size(parameters));

struct Push {
    NakaRushtonParams params;
    uint pixels;
    float white_cd_m2;
};
struct PlanPush {
    NakaRushtonParams params;
    float white_cd_m2;
};

class NakaRushton final : public Model, public PlansTone {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<NakaRushton>();
        const auto storage = gpu::BindingKind::storage_buffer;
        ENTOPTIC_TRY(kernel, gpu::Kernel::create(context.device, {"tone.naka_rushton", naka_rushton_comp_spv, {storage, storage}, sizeof(Push), {}}));
        ENTOPTIC_TRY(plan, gpu::Kernel::create(context.device, {"tone.naka_rushton.plan", naka_rushton_plan_comp_spv, {storage}, sizeof(PlanPush), {}}));
        model->kernel_ = std::move(kernel);
        model->plan_ = std::move(plan);
        return model;
    }
    void set_parameters(std::span<const float> v) override { params_ = {v[0], v[1], v[2], v[3]}; }
    Result<void> plan(StageIo& io) override {
        io.commands.dispatch(plan_, {io.state}, PlanPush{params_, io.display.white_cd_m2}, {io.views, 1, 1});
        return {};
    }
    Result<void> record(StageIo& io) override {
        const uint pixels = io.width * io.height;
        io.commands.dispatch(kernel_, {io.scene, io.state}, Push{params_, pixels, io.display.white_cd_m2}, {gpu::groups_for(pixels, 256), 1, io.views});
        return {};
    }

private:
    gpu::Kernel kernel_, plan_;
    NakaRushtonParams params_{};
};

}  // namespace

std::unique_ptr<ReferenceModel> make_naka_rushton_reference();

extern const ModelEntry naka_rushton_entry;
const ModelEntry naka_rushton_entry{"tone",     "naka_rushton",       "The photoreceptor's response (Jacobs 2015)",
                                    parameters, &NakaRushton::create, &make_naka_rushton_reference};

}  // namespace entoptic::perception
