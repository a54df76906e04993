// Curves of the slot `dof`.
#include "perception/curves/blur_disc.glsl"
#include "perception/curves/curve_references.h"
#include "perception/curves/curve_table.h"
#include "perception/dof/liu_range_math.glsl"

#include "perception/curves/dof_disc_dioptric_disc.comp.h"
#include "perception/curves/dof_disc_liu_range.comp.h"

namespace entoptic::perception {
namespace {

double thin_lens_disc(const CurveInput& in, double x) { return dioptric_disc::disc_deg(in.as<DioptricDiscParams>(), {in.own[0], in.own[1], in.own[2]}, x); }
// The disc grows with the pixel's angle, so that any pixel will do.
double range_disc(const CurveInput& in, double x) {
    const auto pixel = static_cast<double>(liu_range::paper_pixel_rad);
    return glm::degrees(2 * pixel * liu_range::blur_radii_px(in.as<LiuRangeParams>(), 1 / x, 1 / in.own[0], in.own[1], pixel).x);
}

}  // namespace

std::vector<Curve> dof_curves() {
    static const CurveKind kind{"dof.disc", "dof", "object distance", "m", 0.02, 1e9, "diameter of the blur disc", "degrees",
                                {{"focus_m", "m", 0.05, 1e9, 1, "distance that the eye is focused on"},
                                 {"pupil_mm", "mm", 1, 9, 4, "diameter of the pupil"},
                                 {"wavelength_nm", "nm", 380, 780, 0, "with the eye's chromatic aberration; left out: without", true}}};
    // What of the disc is drawn is less by the model's deadband; the curve is the optics alone unless asked.
    return {{&kind, "dioptric_disc", dof_disc_dioptric_disc_comp_spv, &each<thin_lens_disc>, &each<curve_reference::dioptric_disc>,
             {{"strength", {"strength"}}, {"deadband_dioptre", {"deadband_dioptre"}, 0.0f}}, {}, nullptr, 1e-4, 1e-2},
            {&kind, "liu_range", dof_disc_liu_range_comp_spv, &each<range_disc>, &each<curve_reference::liu_range_disc>,
             {{"strength", {"strength"}}, {"max_radius_px", {"max_radius_px"}}, {"as_printed", {"as_printed"}}}, {"wavelength_nm"}, nullptr, 1e-3, 1e-2}};
}

}  // namespace entoptic::perception
