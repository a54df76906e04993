// One operator for mesopic colour on scene light: luminance goes over from the cones' weights to the rods', colour to one tint (Krawczyk
// 2005, equation 14 of Luidolt 2020 and section 2.3 of Jacobs 2015 are this operator with different weights and shares). Compiled in
// float and in double.
#ifndef ENTOPTIC_PERCEPTION_MESOPIC_ROD_VISION_MATH_GLSL
#define ENTOPTIC_PERCEPTION_MESOPIC_ROD_VISION_MATH_GLSL

#include "perception/mesopic/rod_vision_weights.h"
#include "shaders/colour_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::rod_vision)
#ifdef __cplusplus
using namespace entoptic::colour;
#endif

// Mesopic luminance: cones' share rho of the photopic and the rest of the scotopic luminance, normalised by what a lumen counts in each.
FN real mesopic_luminance(RodVision v, rvec3 c, real rho) {
    real cones = luminance(c), rods = real(v.weight_r) * c.x + real(v.weight_g) * c.y + real(v.weight_b) * c.z;
    return (rho * cones + (LIT(1.0) - rho) * real(v.gain) * rods) / (rho + (LIT(1.0) - rho) * real(v.rod_lumen));
}

// What an eye with the cones' share rho sees of colour c (cd/m²): the mesopic luminance, in a blend of the colour's own ratios and the
// tint, which has luminance 1. rho = 1 is exactly c.
FN rvec3 with_rods(RodVision v, rvec3 c, real rho) {
    if (rho >= LIT(1.0)) return c;
    rvec3 tint = rvec3(real(v.tint_r), real(v.tint_g), real(v.tint_b));
    rvec3 ratios = c / max(luminance(c), LIT(1e-9));
    return mesopic_luminance(v, c, rho) * (rho * ratios + (LIT(1.0) - rho) * tint);
}

ENTOPTIC_MATH_END

#endif
