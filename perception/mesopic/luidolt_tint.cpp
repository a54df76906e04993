#include "perception/mesopic/luidolt_tint_params.h"
#include "perception/mesopic/mesopic.h"

#include "perception/mesopic/luidolt_tint.comp.h"
#include "perception/mesopic/luidolt_tint_gate.comp.h"

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 1, 1, "choice: taste", "how much of the tint is shown; 0 switches it off"},
    {"tint_r", "1", 0, 3, 1.05f, "Luidolt 2020, equation 14, after Krawczyk 2005", "red of the colour of rod vision"},
    {"tint_g", "1", 0, 3, 0.97f, "Luidolt 2020, equation 14, after Krawczyk 2005", "green of the colour of rod vision"},
    {"tint_b", "1", 0, 3, 1.27f, "Luidolt 2020, equation 14, after Krawczyk 2005", "blue of the colour of rod vision"},
    {"cut_cd_m2", "cd/m²", 0, 1e4f, 0, "choice: exact end of the tint, 10 is sensible (trap L22)",
     "adaptation from which there is no tint; 0 keeps the tail"},
    {"as_printed", "bool", 0, 1, 0, "Luidolt 2020, equation 14", "1 uses the tint as printed, of luminance 1.0087 (trap L20)"},
};
static_assert(sizeof(LuidoltTintParams) == sizeof(float) * std::size(parameters));

struct GatePush {
    LuidoltTintParams params;
    uint groups, views;
};
struct Push {
    LuidoltTintParams params;
    uint pixels;
    float white_cd_m2, black_cd_m2;
};

class LuidoltTint final : public Model {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<LuidoltTint>();
        const auto storage = gpu::BindingKind::storage_buffer;
        ENTOPTIC_TRY(
            gate, gpu::Kernel::create(context.device,
                                      {"mesopic.luidolt_tint.gate", luidolt_tint_gate_comp_spv, {storage, storage}, sizeof(GatePush), {}}));
        ENTOPTIC_TRY(kernel, gpu::Kernel::create(context.device,
                                                 {"mesopic.luidolt_tint", luidolt_tint_comp_spv, {storage, storage}, sizeof(Push), {}}));
        model->gate_ = std::move(gate);
        model->kernel_ = std::move(kernel);
        return model;
    }
    void set_parameters(std::span<const float> v) override { params_ = {v[0], v[1], v[2], v[3], v[4], v[5]}; }
    bool is_identity() const override { return params_.strength == 0; }
    Result<void> record(StageIo& io) override {
        const uint pixels = io.width * io.height;
        io.commands.dispatch(gate_, {io.state, io.gate}, GatePush{params_, gpu::groups_for(pixels, 256), io.views}, {1, 1, 1});
        io.commands.barrier();
        const Push push{params_, pixels, io.display.white_cd_m2, io.display.black_cd_m2};
        io.commands.dispatch_indirect(kernel_, {io.scene, io.state}, push, io.gate, offsetof(Gate, dispatch));
        return {};
    }

private:
    gpu::Kernel gate_, kernel_;
    LuidoltTintParams params_{};
};

}  // namespace

std::unique_ptr<ReferenceModel> make_luidolt_tint_reference();

extern const ModelEntry luidolt_tint_entry;
const ModelEntry luidolt_tint_entry{
    "mesopic",  "luidolt_tint",       "Purple tint of dim light by the rods' share (Luidolt 2020, equation 14)",
    parameters, &LuidoltTint::create, &make_luidolt_tint_reference};

}  // namespace entoptic::perception
