#include "perception/dof/dioptric_disc_params.h"
#include "perception/dof/dof_model.h"

#include "perception/dof/dioptric_disc_pixels.comp.h"
#include "perception/dof/dioptric_disc_range.comp.h"

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    dof_parameters::strength,
    dof_parameters::focus_dioptre,
    dof_parameters::use_vergence,
    dof_parameters::focus_tau_s,
    {"deadband_dioptre", "1/m", 0, 0.5f, 0.15f, "choice: half of the eye's depth of focus of about 0.3 (trap Li8)",
     "defocus that is not seen"},
    {"max_radius_px", "px", 1, max_disc_radius_px, max_disc_radius_px, "choice: cost", "widest disc"},
    {"lca", "bool", 0, 1, 0, "Thibos 1992; off: the wearer's own eye has it", "1 gives each colour its own focus"},
    dof_parameters::roulette,
};
static_assert(sizeof(DioptricDiscParams) == sizeof(float) * std::size(parameters));

Result<std::unique_ptr<Model>> create(const ModelContext& context) {
    return DofModel<DioptricDiscParams, dof_colours_lca>::create(context, "dof.dioptric_disc", dioptric_disc_range_comp_spv,
                                                                 dioptric_disc_pixels_comp_spv);
}

}  // namespace

std::unique_ptr<ReferenceModel> make_dioptric_disc_reference();

extern const ModelEntry dioptric_disc_entry;
const ModelEntry dioptric_disc_entry{"dof",      "dioptric_disc", "Discs of pupil times defocus: thin-lens depth of field in dioptres",
                                     parameters, &create,         &make_dioptric_disc_reference};

}  // namespace entoptic::perception
