// The blur disc of dioptric_disc at one wavelength. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_CURVES_BLUR_DISC_GLSL
#define ENTOPTIC_PERCEPTION_CURVES_BLUR_DISC_GLSL

#include "perception/curves/curve_settings.h"
#include "perception/dof/dioptric_disc_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::dioptric_disc)
#ifdef __cplusplus
using entoptic::perception::curve_settings::BlurDisc;
#endif

FN real disc_deg(DioptricDiscParams p, BlurDisc disc, real distance_m) {
    // Together: near the focus the difference of two reciprocals would lose its digits.
    real defocus = (disc.focus_m - distance_m) / (distance_m * disc.focus_m);
    if (disc.wavelength_nm > LIT(0.0)) defocus += chromatic_dioptre(LIT(1e-3) * disc.wavelength_nm);
    return LIT(57.29577951308232) * real(p.strength) * disc_angle_rad(disc.pupil_mm, seen_defocus(defocus, real(p.deadband_dioptre)));
}

ENTOPTIC_MATH_END

#endif
