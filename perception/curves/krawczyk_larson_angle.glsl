// The blur of krawczyk_larson in visual angle. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_CURVES_KRAWCZYK_LARSON_ANGLE_GLSL
#define ENTOPTIC_PERCEPTION_CURVES_KRAWCZYK_LARSON_ANGLE_GLSL

#include "perception/acuity/krawczyk_larson_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::krawczyk_larson)

// Standard deviation (arcmin) on a panel of this many pixels per degree; without a panel (0) that of equation 11 itself.
FN real blur_arcmin(KrawczykLarsonParams p, real y, real ppd) {
    if (ppd <= LIT(0.0)) return real(p.strength) * sigma_arcmin(y);
    return acuity_sigma_px(p, lightness(y), ppd) * LIT(60.0) / ppd;
}

ENTOPTIC_MATH_END

#endif
