// The pupil of an eye in the scene from that of the wearer, who looks at the panel. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_PUPIL_RESIDUAL_PUPIL_MATH_GLSL
#define ENTOPTIC_PERCEPTION_PUPIL_RESIDUAL_PUPIL_MATH_GLSL

#include "perception/pupil/residual_pupil_params.h"
#include "perception/pupil/watson_yellott_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::residual_pupil)
#ifdef __cplusplus
using namespace entoptic::perception::watson_yellott;
#endif

// By how much the scene's light opens a pupil of this age more than the panel's, mm (Watson and Yellott 2012). Exactly 0 for equal light.
FN real opening_mm(ResidualPupilParams p, real scene_cd_m2, real displayed_cd_m2, real area_deg2) {
    if (scene_cd_m2 == displayed_cd_m2) return LIT(0.0);
    return diameter_mm(scene_cd_m2 * area_deg2, real(p.age)) - diameter_mm(displayed_cd_m2 * area_deg2, real(p.age));
}

// A pupil constricts faster than it dilates.
FN real followed_mm(ResidualPupilParams p, real before, real target, real dt_s) {
    if (!(dt_s > LIT(0.0))) return before;
    return clamp(target, before - real(p.constriction_mm_s) * dt_s, before + real(p.dilation_mm_s) * dt_s);
}

FN real simulated_mm(ResidualPupilParams p, real measured_mm, real opening) {
    if (opening == LIT(0.0)) return measured_mm;
    return clamp(measured_mm + opening, min(real(p.least_mm), measured_mm), max(real(p.most_mm), measured_mm));
}

ENTOPTIC_MATH_END

#endif
