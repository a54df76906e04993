// Krawczyk, Myszkowski and Seidel 2005, equation 11 of Luidolt 2020: each pixel is blurred by the acuity at its own luminance. Compiled in
// float and in double.
#ifndef ENTOPTIC_PERCEPTION_ACUITY_KRAWCZYK_LARSON_MATH_GLSL
#define ENTOPTIC_PERCEPTION_ACUITY_KRAWCZYK_LARSON_MATH_GLSL

#include "perception/acuity/krawczyk_larson_params.h"
#include "perception/acuity/larson_increment_math.glsl"
#include "perception/acuity/luidolt_eq12_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::krawczyk_larson)
#ifdef __cplusplus
using namespace entoptic::perception::larson_increment;
using namespace entoptic::perception::luidolt_eq12;
#endif

// Standard deviation in pixels of the kernel for a pixel of lightness l. Weights are integrated over pixels, which adds a box's variance of
// 1/12 px²: it is taken off, so that the blur is that of equation 11, and nothing where that is narrower than a pixel.
FN real acuity_sigma_px(KrawczykLarsonParams p, real l, real ppd) {
    real sigma = real(p.strength) * sigma_arcmin(luminance_of(max(l, LIT(0.0)))) * ppd / LIT(60.0);
    return min(sqrt(max(sigma * sigma - LIT(1.0) / LIT(12.0), LIT(0.0))), real(max_sigma_px));
}

ENTOPTIC_MATH_END

#endif
