// Jacobs, Gallo, Cooper, Pulli and Levoy 2015, equation 3: log10 of the adaptation luminance moves at constant speed. Compiled in float and in
// double.
#ifndef ENTOPTIC_PERCEPTION_ADAPTATION_JACOBS_RAMP_MATH_GLSL
#define ENTOPTIC_PERCEPTION_ADAPTATION_JACOBS_RAMP_MATH_GLSL

#include "perception/adaptation/gaze_luminance.glsl"
#include "perception/adaptation/jacobs_ramp_params.h"

ENTOPTIC_MATH_BEGIN(perception::jacobs_ramp)
#ifdef __cplusplus
using namespace gaze;
#endif

FN GazeParams gaze_of(JacobsRampParams p) {
    return gaze_params(p.sigma_gaze_deg, p.wide_share, p.floor_cd_m2, p.clip_over_median, p.retinal, 0.0f);
}

// Equation 3: the adaptation luminance dt_s after `before`, on its way to `target` (cd/m², both above 0), where it stops.
FN real adapted(JacobsRampParams p, real before, real target, real dt_s) {
    if (!(dt_s > LIT(0.0))) return before;
    real octave = LIT(2.302585092994046) * dt_s * real(p.speed);      // of the natural logarithm, per log10 unit a second
    real to_go = log(target / before);
    real step = to_go > LIT(0.0) ? min(to_go, octave * real(p.up_log10_per_s)) : max(to_go, -octave * real(p.down_log10_per_s));
    real after = step == to_go ? target : before * exp(step);
    return max(after, real(p.floor_cd_m2));
}

ENTOPTIC_MATH_END

#endif
