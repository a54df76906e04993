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

// Equation 4: sensitivity of the rods, 1 in the dark, at luminance y (cd/m²).
FN real rod_sensitivity(real y) { return LIT(0.04) / (LIT(0.04) + y); }

// Equation 3: time constant, s.
FN real time_constant(KrawczykExpLinearParams p, real y) {
    real s = rod_sensitivity(y);
    return s * real(p.tau_rod_s) + (LIT(1.0) - s) * real(p.tau_cone_s);
}

// Equation 2: the adaptation luminance dt_s after `before`, on its way to `target` (cd/m²). The time constant is the target's, so that
// two half steps are one step. dt_s <= 0 or NaN: no change. The state keeps its floor.
FN real adapted(KrawczykExpLinearParams p, real before, real target, real dt_s) {
    if (!(dt_s > LIT(0.0))) return before;
    real x = dt_s * real(p.speed) / time_constant(p, target);
    // A short step is exact as a change of the state, a long one as the rest of the way to the target.
    real after = x < real(short_step) ? before + (target - before) * one_minus_exp(x) : target + (before - target) * exp(-x);
    return max(after, real(p.floor_cd_m2));
}

FN GazeParams gaze_of(KrawczykExpLinearParams p) {
    GazeParams g;
    g.sigma_gaze_deg = p.sigma_gaze_deg;
    g.wide_share = p.wide_share;
    g.floor_cd_m2 = p.floor_cd_m2;
    g.clip_over_median = p.clip_over_median;
    g.retinal = 0.0f;
    g.as_printed = p.as_printed;
    return g;
}

ENTOPTIC_MATH_END

#endif
