// The presets themselves, as data.
#include "perception/preset.h"

namespace entoptic::perception {

std::span<const Preset> presets() {
    static const std::vector<Preset> table = {
        {"off", "No simulation: layers go through warp and lens to the panel, bit for bit", {}, {}},
        {"combined",
         "What the panel cannot show is simulated, the rest is shown as it is: ordinary applications keep their codes",
         {{"pupil", "residual_pupil"},
          {"adaptation", "krawczyk_exp_log"},
          {"glare", "closed_form"},
          {"acuity", "larson_increment"},
          {"mesopic", "jacobs_mesopic"},
          {"tone", "display_identity"},
          {"afterimage", "jacobs"}},
         {}},
        {"luidolt2020",
         "Luidolt et al. 2020 with its errors corrected (facts: traps L1, L2, L5-L9, L12, L14, L18-L20, L23)",
         {{"adaptation", "krawczyk_exp_linear"},
          {"glare", "luidolt_spectral"},
          {"acuity", "luidolt_eq12"},
          {"tone", "key_reinhard"},
          {"mesopic", "luidolt_tint"}},
         {}},
        {"luidolt2020_as_printed",
         "Luidolt et al. 2020 with the equations as printed, for research only",
         {{"adaptation", "krawczyk_exp_linear"},
          {"glare", "luidolt_spectral"},
          {"acuity", "luidolt_eq12"},
          {"tone", "key_reinhard"},
          {"mesopic", "luidolt_tint"}},
         {{"adaptation", "as_printed", 1},
          {"glare", "as_printed", 1},
          {"acuity", "as_printed", 1},
          {"tone", "as_printed", 1},
          {"mesopic", "as_printed", 1}}},
        {"kakimoto2004",
         "Kakimoto et al. 2004: half-closed eyelashes, three wavelengths, the veil through their tone curve (corrected, facts: trap K3)",
         {{"glare", "fraunhofer_mask"}},
         {{"glare", "three_lines", 1}, {"glare", "sigmoid", 1}, {"glare", "lid_open", 0.6f}}},
        {"jacobs2015",
         "Jacobs et al. 2015 with its errors corrected (traps J2, J6-J8, J10-J18)",
         {{"adaptation", "jacobs_ramp"},
          {"acuity", "jacobs_bands"},
          {"mesopic", "jacobs_mesopic"},
          {"tone", "naka_rushton"},
          {"afterimage", "jacobs"}},
         {{"acuity", "photographic", 1}, {"mesopic", "photographic", 1}, {"afterimage", "photographic", 1}}},
        {"liu2021",
         "Liu et al. 2021: depth of field with coloured edges alone (facts: traps Li1-Li5); needs an application that submits depth",
         {{"dof", "liu_range"}},
         {{"dof", "lca", 1}, {"dof", "roulette", 1}}},
    };
    return table;
}

}  // namespace entoptic::perception
