#include "perception/dof/dioptric_disc_params.h"
#include "perception/dof/dof.h"
#include "perception/dof/dof_passes.h"

#include "perception/dof/dioptric_disc_pixels.comp.h"
#include "perception/dof/dioptric_disc_range.comp.h"

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 1, 1, "choice: taste", "multiplies the width of the blur; 0 switches it off"},
    {"focus_dioptre", "1/m", -1, 20, -1, "choice: negative is the eye's own", "fixed focus; negative: the eyes focus on what they look at"},
    {"use_vergence", "bool", 0, 1, 0, "choice: 1 degree of error is 0.28 dioptre",
     "1 focuses where the lines of sight meet, when measured"},
    {"focus_tau_s", "s", 0.01f, 5, 0.3f, "choice: accommodation takes 0.3 to 1 s", "time constant with which the focus follows"},
    {"deadband_dioptre", "1/m", 0, 0.5f, 0.15f, "choice: half of the eye's depth of focus of about 0.3 (trap Li8)",
     "defocus that is not seen"},
    {"max_radius_px", "px", 1, max_disc_radius_px, max_disc_radius_px, "choice: cost", "widest disc"},
    {"lca", "bool", 0, 1, 0, "Thibos 1992; off: the wearer's own eye has it", "1 gives each colour its own focus"},
    {"roulette", "bool", 0, 1, 0, "Liu 2021, equations 10 and 11", "1 samples wide discs: faster, with some noise"},
};
static_assert(sizeof(DioptricDiscParams) == sizeof(float) * std::size(parameters));

class DioptricDisc final : public Model, public NeedsDepth {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<DioptricDisc>();
        ENTOPTIC_TRY(passes, DofPasses::create(context, "dof.dioptric_disc", dioptric_disc_range_comp_spv, dioptric_disc_pixels_comp_spv,
                                               sizeof(DioptricDiscParams)));
        model->passes_ = std::move(passes);
        return model;
    }
    void set_parameters(std::span<const float> v) override { params_ = {v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]}; }
    bool is_identity() const override { return params_.strength == 0; }
    Result<void> record(StageIo& io) override {
        const DofSettings settings{params_.focus_dioptre, params_.use_vergence > 0.5f, params_.focus_tau_s,
                                   params_.lca > 0.5f ? dof_colours_lca : dof_colours_alike, params_.roulette > 0.5f};
        return passes_.record(io, settings, std::as_bytes(std::span(&params_, 1)));
    }

private:
    DofPasses passes_;
    DioptricDiscParams params_{};
};

}  // namespace

std::unique_ptr<ReferenceModel> make_dioptric_disc_reference();

extern const ModelEntry dioptric_disc_entry;
const ModelEntry dioptric_disc_entry{
    "dof",      "dioptric_disc",       "Discs of pupil times defocus: thin-lens depth of field in dioptres",
    parameters, &DioptricDisc::create, &make_dioptric_disc_reference};

}  // namespace entoptic::perception
