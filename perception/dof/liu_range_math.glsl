// Liu et al. 2021, equation 13: blur in units of the depth of field, cut at a small kernel. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_DOF_LIU_RANGE_MATH_GLSL
#define ENTOPTIC_PERCEPTION_DOF_LIU_RANGE_MATH_GLSL

#include "perception/dof/dof_math.glsl"
#include "perception/dof/liu_range_params.h"

ENTOPTIC_MATH_BEGIN(perception::liu_range)
#ifdef __cplusplus
using namespace entoptic::perception::dof;
#endif

// What a pixel of the paper's headset covers, rad: 1440 pixels on 104 degrees, 13.85 pixels per degree (facts 1.2).
const float paper_pixel_rad = 0.0012605f;
// "If DM of a certain scene is infinite, we set it to 1000 m" (section 3.2), as dioptres.
const float farthest_dioptre = 1e-3f;

// Equation 13, clamped to -1..1 (trap Li4): how far beyond (positive) the focus, over the depth of field. In dioptres both are finite for
// any focus; near the focus that is the equation in metres. As printed: in metres, which end at 1000 m.
FN real range_place(LiuRangeParams p, real dioptre, real focus, real pupil_mm) {
    real near = near_limit_dioptre(pupil_mm, focus), far = far_limit_dioptre(pupil_mm, focus);
    real place = (focus - dioptre) / (near - far);
    if (p.as_printed > 0.5) {
        real end = real(farthest_dioptre);
        place = (LIT(1.0) / max(dioptre, end) - LIT(1.0) / max(focus, end)) / (LIT(1.0) / max(far, end) - LIT(1.0) / max(near, LIT(2.0) * end));
    }
    return clamp(place, LIT(-1.0), LIT(1.0));
}

// (radius of a pixel's disc in pixels, 0, 0). Within the depth of field there is none (section 3.3.2).
FN rvec3 blur_radii_px(LiuRangeParams p, real dioptre, real focus, real pupil_mm, real pixel_rad) {
    bool sharp = dioptre <= near_limit_dioptre(pupil_mm, focus) && dioptre >= far_limit_dioptre(pupil_mm, focus);
    real radius = real(p.strength) * real(p.max_radius_px) * abs(range_place(p, dioptre, focus, pupil_mm)) * real(paper_pixel_rad) / pixel_rad;
    return rvec3(sharp ? LIT(0.0) : min(radius, LIT(32.0)), LIT(0.0), LIT(0.0));
}

ENTOPTIC_MATH_END

#endif
