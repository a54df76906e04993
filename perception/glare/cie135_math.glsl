// CIE 135/1-1999, total point spread function of the eye. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_GLARE_CIE135_MATH_GLSL
#define ENTOPTIC_PERCEPTION_GLARE_CIE135_MATH_GLSL

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::cie135)

// Per sr at an angle in degrees, CIE 135/1 (Vos and van den Berg 1999), eq. 8: age in years, pigment 0 (very dark) .. 1.2 (light blue).
FN real total_psf(real deg, real age, real pigment) {
    real a = age / LIT(70.0);
    a = a * a * a * a;
    real t = deg / LIT(0.1);
    real core = deg / LIT(0.0046), flank = deg / LIT(0.045);
    real wide = LIT(1.0) + t * t;
    return (LIT(1.0) - LIT(0.08) * a) * (LIT(9.2e6) / pow(LIT(1.0) + core * core, LIT(1.5)) + LIT(1.5e5) / pow(LIT(1.0) + flank * flank, LIT(1.5))) +
           (LIT(1.0) + LIT(1.6) * a) * (LIT(400.0) / wide + LIT(3e-8) * deg * deg + pigment * (LIT(1300.0) / (wide * sqrt(wide)) + LIT(0.8) / sqrt(wide))) +
           LIT(0.0025) * pigment;
}

ENTOPTIC_MATH_END

#endif
