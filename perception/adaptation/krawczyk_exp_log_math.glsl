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
    GazeParams g;
    g.sigma_gaze_deg = p.sigma_gaze_deg;
    g.wide_share = p.wide_share;
    g.floor_cd_m2 = p.floor_cd_m2;
    g.clip_over_median = p.clip_over_median;
    g.retinal = p.retinal;
    g.as_printed = 0.0f;
    return g;
}

// Equation 3 with the rod sensitivity of equation 4: time constant at luminance y (cd/m²), s.
FN real time_constant(KrawczykExpLogParams p, real y) {
    real rods = LIT(0.04) / (LIT(0.04) + y);
    return rods * real(p.tau_rod_s) + (LIT(1.0) - rods) * real(p.tau_cone_s);
}

// Equation 2 on ln A: the adaptation luminance dt_s after `before`, on its way to `target` (cd/m², both above 0). The time constant is the
// target's, so that two half steps are one step. dt_s <= 0 or NaN: no change.
FN real adapted(KrawczykExpLogParams p, real before, real target, real dt_s) {
    if (!(dt_s > LIT(0.0))) return before;
    real x = dt_s * real(p.speed) / time_constant(p, target);
    real to_go = log(target / before);
    // A short step is exact as a change of the state, a long one as the rest of the way to the target.
    real after = x < real(short_step) ? before * exp(to_go * one_minus_exp(x)) : target * exp(-to_go * exp(-x));
    return max(after, real(p.floor_cd_m2));
}

ENTOPTIC_MATH_END

#endif
