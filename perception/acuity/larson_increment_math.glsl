// Larson, Rushmeier and Piatko 1997: visual acuity by luminance, after Shlaer 1937; and the blur that takes one eye's to another's.
// Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_ACUITY_LARSON_INCREMENT_MATH_GLSL
#define ENTOPTIC_PERCEPTION_ACUITY_LARSON_INCREMENT_MATH_GLSL

#include "perception/acuity/larson_increment_params.h"
#include "perception/acuity/local_blur_math.glsl"
#include "perception/residual.glsl"

ENTOPTIC_MATH_BEGIN(perception::larson_increment)
#ifdef __cplusplus
using namespace entoptic::perception::local_blur;
#endif

// Highest frequency that is resolved at luminance y (cd/m²), cycles per degree: equation 11 of Luidolt 2020, after Larson 1997. Below
// 6.5e-10 cd/m² it would be negative.
FN real resolved_cpd(real y) {
    real log10_y = log(max(y, LIT(1e-8))) * LIT(0.4342944819032518);
    return LIT(17.25) * atan(LIT(1.4) * log10_y + LIT(0.35)) + LIT(25.72);
}

// The Gaussian that stands for that acuity, standard deviation in arc minutes (equation 11): it passes 5.8 % of the frequency.
FN real sigma_arcmin(real y) { return LIT(60.0) / (LIT(1.86) * LIT(1.4142135623730951) * resolved_cpd(y)); }

FN real squared(real x) { return x * x; }

// Variance of the panel's own pixel, a box, arcmin².
FN real pixel_variance(real ppd) { return squared(LIT(60.0) / ppd) / LIT(12.0); }

// Variance to add, arcmin²: variances of blurs in a row add, so what is missing is the scene's eye's less the wearer's less the pixel's.
FN real added_variance(LarsonIncrementParams p, BothEyes eyes, BlurPlace place) {
    real shift = exp(LIT(6.907755278982137) * real(p.randomness) * place.noise);   // 3 decades: from 5 to 0.005 cd/m²
    real wearer = p.photographic > 0.5 ? LIT(0.0) : squared(sigma_arcmin(eyes.panel * shift));
    real missing = squared(sigma_arcmin(eyes.scene * shift)) - wearer - pixel_variance(place.ppd);
    return squared(real(p.strength)) * max(missing, LIT(0.0));
}

// Whether a local mean of this luminance can need a blur; with noise, or within a fifth of the pixel's variance, it may.
FN bool needs_blur(LarsonIncrementParams p, BothEyes eyes, real ppd) {
    if (p.photographic < 0.5 && !(eyes.scene < eyes.panel)) return false;
    real wearer = p.photographic > 0.5 ? LIT(0.0) : squared(sigma_arcmin(eyes.panel));
    return p.randomness > 0.0 || squared(sigma_arcmin(eyes.scene)) - wearer > LIT(0.8) * pixel_variance(ppd);
}

ENTOPTIC_MATH_END

#endif
