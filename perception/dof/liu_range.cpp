#include "perception/dof/liu_range_params.h"
#include "perception/dof/dof.h"
#include "perception/dof/dof_passes.h"

#include "perception/dof/liu_range_pixels.comp.h"
#include "perception/dof/liu_range_range.comp.h"

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 1, 1, "choice: taste", "multiplies the width of the blur; 0 switches it off"},
    {"focus_dioptre", "1/m", -1, 20, -1, "choice: negative is the eye's own", "fixed focus; negative: the eyes focus on what they look at"},
    {"use_vergence", "bool", 0, 1, 0, "choice: 1 degree of error is 0.28 dioptre",
     "1 focuses where the lines of sight meet, when measured"},
    {"focus_tau_s", "s", 0.01f, 5, 0.3f, "choice: accommodation takes 0.3 to 1 s", "time constant with which the focus follows"},
    {"max_radius_px", "px", 1, 32, 3, "choice: seven rows leave three with all colours", "widest disc, at 13.85 pixels per degree"},
    {"lca", "bool", 0, 1, 0, "Liu 2021, section 3.3.2", "1 colours the kernel's outer rows"},
    {"roulette", "bool", 0, 1, 0, "Liu 2021, equations 10 and 11", "1 samples wide discs: faster, with some noise"},
    {"as_printed", "bool", 0, 1, 0, "Liu 2021, equation 13", "1 measures in metres, which fails for a far focus (trap Li4)"},
};
static_assert(sizeof(LiuRangeParams) == sizeof(float) * std::size(parameters));

class LiuRange final : public Model, public NeedsDepth {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<LiuRange>();
        ENTOPTIC_TRY(passes, DofPasses::create(context, "dof.liu_range", liu_range_range_comp_spv, liu_range_pixels_comp_spv,
                                               sizeof(LiuRangeParams)));
        model->passes_ = std::move(passes);
        return model;
    }
    void set_parameters(std::span<const float> v) override { params_ = {v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]}; }
    bool is_identity() const override { return params_.strength == 0; }
    Result<void> record(StageIo& io) override {
        const DofSettings settings{params_.focus_dioptre, params_.use_vergence > 0.5f, params_.focus_tau_s,
                                   params_.lca > 0.5f ? dof_colours_rows : dof_colours_alike, params_.roulette > 0.5f};
        return passes_.record(io, settings, std::as_bytes(std::span(&params_, 1)));
    }

private:
    DofPasses passes_;
    LiuRangeParams params_{};
};

}  // namespace

std::unique_ptr<ReferenceModel> make_liu_range_reference();

extern const ModelEntry liu_range_entry;
const ModelEntry liu_range_entry{"dof",      "liu_range",       "Blur in units of the depth of field (Liu 2021, equation 13, in dioptres)",
                                 parameters, &LiuRange::create, &make_liu_range_reference};

}  // namespace entoptic::perception
