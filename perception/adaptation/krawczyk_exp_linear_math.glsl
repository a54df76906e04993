// Krawczyk, Myszkowski and Seidel 2005 as in Luidolt et al. 2020, equations 2-4: the adaptation luminance follows a gaze-weighted mean
// of the scene with the time constants of rods and cones. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_ADAPTATION_KRAWCZYK_EXP_LINEAR_MATH_GLSL
#define ENTOPTIC_PERCEPTION_ADAPTATION_KRAWCZYK_EXP_LINEAR_MATH_GLSL

#include "perception/adaptation/gaze_luminance.glsl"
#include "perception/adaptation/krawczyk_exp_linear_params.h"

ENTOPTIC_MATH_BEGIN(perception::krawczyk_exp_linear)
#ifdef __cplusplus
using namespace gaze;
#endif

// Equation 3: time constant, s.
FN real time_constant(KrawczykExpLinearParams p, real y) { return rods_and_cones_s(p.tau_rod_s, p.tau_cone_s, y); }

// Equation 2: the adaptation luminance dt_s after `before`, on its way to `target` (cd/m²). The time constant is the target's, so that
// two half steps are one step. dt_s <= 0 or NaN: no change. The state keeps its floor.
FN real adapted(KrawczykExpLinearParams p, real before, real target, real dt_s) {
    if (!(dt_s > LIT(0.0))) return before;
    return max(approached(before, target, dt_s * real(p.speed) / time_constant(p, target)), real(p.floor_cd_m2));
}

FN GazeParams gaze_of(KrawczykExpLinearParams p) {
    return gaze_params(p.sigma_gaze_deg, p.wide_share, p.floor_cd_m2, p.clip_over_median, 0.0f, p.as_printed);
}

ENTOPTIC_MATH_END

#endif
