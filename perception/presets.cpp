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
         "Luidolt et al. 2020 with its errors corrected: docs/luidolt2020_corrections.md lists them",
         {{"pupil", "luidolt_pupil"},
          {"adaptation", "krawczyk_exp_linear"},
          {"glare", "luidolt_spectral"},
          {"acuity", "luidolt_eq12"},
          {"tone", "key_reinhard"},
          {"mesopic", "luidolt_tint"}},
         {}},
        {"luidolt2020_as_printed",
         "Luidolt et al. 2020 with the equations as printed, for research only",
         {{"pupil", "luidolt_pupil"},
          {"adaptation", "krawczyk_exp_linear"},
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
         "Kakimoto et al. 2004: half-closed eyelashes, three wavelengths, the veil through their tone curve, whose printed numerator is corrected",
         {{"glare", "fraunhofer_mask"}},
         {{"glare", "three_lines", 1}, {"glare", "sigmoid", 1}, {"glare", "lid_open", 0.6f}, {"glare", "zones", 5}}},
        {"jacobs2015",
         "Jacobs et al. 2015 with its errors corrected and its gaps filled, as the pages of its models say",
         {{"adaptation", "jacobs_ramp"},
          {"acuity", "jacobs_bands"},
          {"mesopic", "jacobs_mesopic"},
          {"tone", "naka_rushton"},
          {"afterimage", "jacobs"}},
         {{"acuity", "photographic", 1}, {"mesopic", "photographic", 1}, {"afterimage", "photographic", 1}}},
        {"liu2021",
         "Liu et al. 2021: depth of field with coloured edges alone, its misprints corrected; needs an application that submits depth",
         {{"dof", "liu_range"}},
         {{"dof", "lca", 1}, {"dof", "roulette", 1}}},
    };
    return table;
}

}  // namespace entoptic::perception
