// What only luidolt_spectral needs: the spline by which its particles are spread over the samples of the pupil. Compiled in float and double.
#ifndef ENTOPTIC_PERCEPTION_GLARE_LUIDOLT_SPECTRAL_MATH_GLSL
#define ENTOPTIC_PERCEPTION_GLARE_LUIDOLT_SPECTRAL_MATH_GLSL

#include "perception/glare/glare_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::luidolt_spectral)

// Cubic B-spline; integrates to 1, transform sinc^4.
FN real bspline(real t) {
    real a = abs(t);
    if (a >= LIT(2.0)) return LIT(0.0);
    real b = LIT(2.0) - a;
    if (a >= LIT(1.0)) return b * b * b / LIT(6.0);
    return LIT(0.6666666666666666) - a * a + LIT(0.5) * a * a * a;
}

FN real sinc(real t) {
    real x = LIT(3.141592653589793) * t;
    return abs(x) < LIT(1e-4) ? LIT(1.0) - x * x / LIT(6.0) : sin(x) / x;
}

ENTOPTIC_MATH_END

#endif
