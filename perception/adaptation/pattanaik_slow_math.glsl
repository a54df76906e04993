// Fast neural adaptation and slow recovery of bleached pigment: the pigment kinetics of Pattanaik, Tumblin, Yee and Greenberg 2000 (after Hunt
// 1995) with the equivalent background of Stiles and Crawford 1932. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_ADAPTATION_PATTANAIK_SLOW_MATH_GLSL
#define ENTOPTIC_PERCEPTION_ADAPTATION_PATTANAIK_SLOW_MATH_GLSL

#include "perception/adaptation/gaze_luminance.glsl"
#include "perception/adaptation/pattanaik_slow_params.h"

ENTOPTIC_MATH_BEGIN(perception::pattanaik_slow)
#ifdef __cplusplus
using namespace gaze;
#endif

FN GazeParams gaze_of(PattanaikSlowParams p) {
    return gaze_params(p.sigma_gaze_deg, p.wide_share, p.floor_cd_m2, p.clip_over_median, p.retinal, 0.0f);
}

// Pigment recovers with t0 (s) and is bleached by light with K (cd/m² s): du/dt = (1 - u)/t0 - u Y/K for its unbleached share u.
struct Pigment {
    real recovery_s, bleaching;
};
FN Pigment rod_pigment() {
    Pigment p;
    p.recovery_s = LIT(400.0);
    p.bleaching = LIT(16.0);
    return p;
}
FN Pigment cone_pigment() {
    Pigment p;
    p.recovery_s = LIT(110.0);
    p.bleaching = LIT(2.2e8);
    return p;
}

// Luminance at which half of the pigment is bleached in the end, cd/m²: 0.04 for rods, 2e6 for cones.
FN real half_bleaching(Pigment p) { return p.bleaching / p.recovery_s; }
FN real settled_unbleached(Pigment p, real y) { return LIT(1.0) / (LIT(1.0) + y / half_bleaching(p)); }
FN real settled_bleached(Pigment p, real y) { return y / (y + half_bleaching(p)); }

// A share dt_s later, on its way to `settled` under y: exact for constant light.
FN real pigment_after(Pigment p, real share, real settled, real y, real dt_s) {
    return approached(share, settled, dt_s * (LIT(1.0) / p.recovery_s + y / p.bleaching));
}

// Equivalent background: the steady light that would leave as much pigment bleached, cd/m².
FN real rod_background(real unbleached) { return half_bleaching(rod_pigment()) * (LIT(1.0) - unbleached) / max(unbleached, LIT(1e-30)); }
FN real cone_background(real bleached) { return half_bleaching(cone_pigment()) * bleached / max(LIT(1.0) - bleached, LIT(1e-30)); }

// The adaptation luminance: never below what the more sensitive of rods and cones still lacks pigment for.
FN real with_pigment(real neural, real rod_unbleached, real cone_bleached) {
    return max(neural, min(rod_background(rod_unbleached), cone_background(cone_bleached)));
}

// The neural part: Krawczyk's time constants (Luidolt et al. 2020, equations 3 and 4) on ln A, as krawczyk_exp_log.
FN real neural_after(PattanaikSlowParams p, real before, real target, real dt_s) {
    if (!(dt_s > LIT(0.0))) return before;
    real x = dt_s * real(p.speed) / rods_and_cones_s(p.tau_rod_s, p.tau_cone_s, target);
    return max(approached_in_log(before, target, x), real(p.floor_cd_m2));
}

ENTOPTIC_MATH_END

#endif
