#include "perception/mesopic/krawczyk_tint_params.h"
#include "perception/mesopic/mesopic.h"

#include "perception/mesopic/krawczyk_tint.comp.h"
#include "perception/mesopic/krawczyk_tint_gate.comp.h"

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 1, 1, "choice: taste", "how much of the tint is shown; 0 switches it off"},
    {"photographic", "bool", 0, 1, 0, "choice: residual law", "1 shows all that an eye in the scene sees, 0 what the wearer's own eye does not do"},
    {"tint_r", "1", 0, 3, 1.05f, "Luidolt 2020, equation 14, after Krawczyk 2005", "red of the colour of rod vision"},
    {"tint_g", "1", 0, 3, 0.97f, "Luidolt 2020, equation 14, after Krawczyk 2005", "green of the colour of rod vision"},
    {"tint_b", "1", 0, 3, 1.27f, "Luidolt 2020, equation 14, after Krawczyk 2005", "blue of the colour of rod vision"},
};
static_assert(sizeof(KrawczykTintParams) == sizeof(float) * std::size(parameters));

struct GatePush {
    KrawczykTintParams params;
    uint groups, views;
    float black_cd_m2;
};
struct Push {
    KrawczykTintParams params;
    uint pixels;
    float white_cd_m2, black_cd_m2;
};

class KrawczykTint final : public Model {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<KrawczykTint>();
        const auto storage = gpu::BindingKind::storage_buffer;
        ENTOPTIC_TRY(gate, gpu::Kernel::create(context.device, {"mesopic.krawczyk_tint.gate", krawczyk_tint_gate_comp_spv,
                                                               {storage, storage, storage}, sizeof(GatePush), {}}));
        ENTOPTIC_TRY(kernel, gpu::Kernel::create(context.device,
                                                 {"mesopic.krawczyk_tint", krawczyk_tint_comp_spv, {storage, storage}, sizeof(Push), {}}));
        model->gate_ = std::move(gate);
        model->kernel_ = std::move(kernel);
        return model;
    }
    void set_parameters(std::span<const float> v) override { params_ = {v[0], v[1], v[2], v[3], v[4]}; }
    bool is_identity() const override { return params_.strength == 0; }
    Result<void> record(StageIo& io) override {
        const uint pixels = io.width * io.height;
        const GatePush gate{params_, gpu::groups_for(pixels, 256), io.views, io.display.black_cd_m2};
        io.commands.dispatch(gate_, {io.state, io.statistics, io.gate}, gate, {1, 1, 1});
        io.commands.barrier();
        const Push push{params_, pixels, io.display.white_cd_m2, io.display.black_cd_m2};
        io.commands.dispatch_indirect(kernel_, {io.state, io.scene}, push, io.gate, offsetof(Gate, dispatch));
        return {};
    }

private:
    gpu::Kernel gate_, kernel_;
    KrawczykTintParams params_{};
};

}  // namespace

std::unique_ptr<ReferenceModel> make_krawczyk_tint_reference();

extern const ModelEntry krawczyk_tint_entry;
const ModelEntry krawczyk_tint_entry{"mesopic",  "krawczyk_tint",       "Purple tint of dim pixels by the rods' share at each pixel (Krawczyk 2005)",
                                     parameters, &KrawczykTint::create, &make_krawczyk_tint_reference};

}  // namespace entoptic::perception
