#include "app/bench/trades.h"

namespace entoptic::app {

std::span<const Trade> trades() {
    static const std::vector<Trade> table{
        {"glare", "", "wavelengths", {32, 16, 8, 4, 3}, "wavelengths"},
        {"glare", "", "texel_px", {1, 2, 4, 8}, "resolution"},
        {"glare", "fraunhofer_mask", "near_px", {24, 16, 12, 8, 4, 0}, "kernel size"},
        {"glare", "", "near_px", {16, 15, 12, 8, 4, 0}, "kernel size"},
        {"glare", "luidolt_spectral", "near_from", {0, 4, 16, 32, 64}, "window"},
        {"glare", "luidolt_spectral", "patches", {0, 16, 64, 256}, "texture"},
        {"glare", "luidolt_spectral", "radius_deg", {180, 30, 10}, "kernel size"},
        {"glare", "luidolt_spectral", "window_sigma_deg", {0, 10}, "window"},
        {"glare", "", "rebuild_mm", {0.05, 0.1, 0.2, 0.4}, "reuse", false, true},
        {"glare", "closed_form", "emission_spectra", {1, 0}, "coloured light", true},
        {"glare", "fraunhofer_mask", "billboard_texels", {0, 40}, "billboards or transforms"},
        {"glare", "fraunhofer_mask", "zones", {3, 1}, "resolution", true},
        {"acuity", "luidolt_eq12", "as_printed", {0, 1}, "2-D or separable"},
        {"dof", "dioptric_disc", "max_radius_px", {32, 16, 8}, "kernel size"},
        {"dof", "", "roulette", {0, 1}, "samples"},
        {"afterimage", "", "resolution", {1, 0.5, 0.25, 0.125}, "resolution"},
    };
    return table;
}

}  // namespace entoptic::app
