// The filter of Krawczyk, Myszkowski and Seidel 2005 (Luidolt et al. 2020, equations 2-4) on the logarithm of luminance. Compiled in float
// and in double.
#ifndef ENTOPTIC_PERCEPTION_ADAPTATION_KRAWCZYK_EXP_LOG_MATH_GLSL
#define ENTOPTIC_PERCEPTION_ADAPTATION_KRAWCZYK_EXP_LOG_MATH_GLSL

#include "perception/adaptation/gaze_luminance.glsl"
#include "perception/adaptation/krawczyk_exp_log_params.h"

ENTOPTIC_MATH_BEGIN(perception::krawczyk_exp_log)
#ifdef __cplusplus
using namespace gaze;
#endif

FN GazeParams gaze_of(KrawczykExpLogParams p) {
    return gaze_params(p.sigma_gaze_deg, p.wide_share, p.floor_cd_m2, p.clip_over_median, p.retinal, 0.0f);
}

// Equation 3: time constant at luminance y (cd/m²), s.
FN real time_constant(KrawczykExpLogParams p, real y) { return rods_and_cones_s(p.tau_rod_s, p.tau_cone_s, y); }

// Equation 2 on ln A: the adaptation luminance dt_s after `before`, on its way to `target` (cd/m², both above 0). The time constant is the
// target's, so that two half steps are one step. dt_s <= 0 or NaN: no change.
FN real adapted(KrawczykExpLogParams p, real before, real target, real dt_s) {
    if (!(dt_s > LIT(0.0))) return before;
    return max(approached_in_log(before, target, dt_s * real(p.speed) / time_constant(p, target)), real(p.floor_cd_m2));
}

ENTOPTIC_MATH_END

#endif
