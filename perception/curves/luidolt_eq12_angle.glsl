// Equation 12 of Luidolt et al. 2020 in visual angle. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_CURVES_LUIDOLT_EQ12_ANGLE_GLSL
#define ENTOPTIC_PERCEPTION_CURVES_LUIDOLT_EQ12_ANGLE_GLSL

#include "perception/acuity/luidolt_eq12_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::luidolt_eq12)

FN real sigma_arcmin(LuidoltEq12Params p, real y) {
    real ppd = real(paper_ppd);
    return LIT(60.0) / ppd * blur_sigma_px(p, lightness(y), ppd);
}

// The frequency that this Gaussian passes by 5.8 %, the convention of equation 11, but no more than the paper's headset can show.
FN real cutoff_cpd(LuidoltEq12Params p, real y) {
    return min(LIT(60.0) / (LIT(2.630437226) * max(sigma_arcmin(p, y), LIT(1e-6))), LIT(0.5) * real(paper_ppd));
}

ENTOPTIC_MATH_END

#endif
