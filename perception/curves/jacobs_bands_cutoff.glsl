// What jacobs_bands leaves of a picture, as a frequency. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_CURVES_JACOBS_BANDS_CUTOFF_GLSL
#define ENTOPTIC_PERCEPTION_CURVES_JACOBS_BANDS_CUTOFF_GLSL

#include "perception/acuity/jacobs_bands_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::jacobs_bands)

// The frequency that the Gaussian which is left passes by 5.8 % (the convention of Luidolt 2020, equation 11), but no more than the paper's
// monitor of 65.5 pixels per degree can show.
FN real cutoff_cpd(JacobsBandsParams p, real y) {
    return min(LIT(60.0) / (LIT(2.630437226) * sqrt(max(lost_variance(p, y, LIT(0.0)), LIT(1e-12)))), LIT(32.75));
}

ENTOPTIC_MATH_END

#endif
