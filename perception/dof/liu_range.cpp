#include "perception/dof/liu_range_params.h"
#include "perception/dof/dof_model.h"

#include "perception/dof/liu_range_pixels.comp.h"
#include "perception/dof/liu_range_range.comp.h"

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    dof_parameters::strength,
    dof_parameters::focus_dioptre,
    dof_parameters::use_vergence,
    dof_parameters::focus_tau_s,
    {"max_radius_px", "px", 1, 32, 3, "choice: seven rows leave three with all colours", "widest disc, at 13.85 pixels per degree"},
    {"lca", "bool", 0, 1, 0, "Liu 2021, section 3.3.2", "1 colours the kernel's outer rows"},
    dof_parameters::roulette,
    {"as_printed", "bool", 0, 1, 0, "Liu 2021, equation 13", "1 measures in metres, which fails for a far focus (trap Li4)"},
};
static_assert(sizeof(LiuRangeParams) == sizeof(float) * std::size(parameters));

Result<std::unique_ptr<Model>> create(const ModelContext& context) {
    return DofModel<LiuRangeParams, dof_colours_rows>::create(context, "dof.liu_range", liu_range_range_comp_spv,
                                                              liu_range_pixels_comp_spv);
}

}  // namespace

std::unique_ptr<ReferenceModel> make_liu_range_reference();

extern const ModelEntry liu_range_entry;
const ModelEntry liu_range_entry{"dof",      "liu_range", "Blur in units of the depth of field (Liu 2021, equation 13, in dioptres)",
                                 parameters, &create,     &make_liu_range_reference};

}  // namespace entoptic::perception
