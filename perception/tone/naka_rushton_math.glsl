// Naka and Rushton 1966 as in Jacobs et al. 2015, equations 1 and 2: the photoreceptor's response. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_TONE_NAKA_RUSHTON_MATH_GLSL
#define ENTOPTIC_PERCEPTION_TONE_NAKA_RUSHTON_MATH_GLSL

#include "perception/tone/naka_rushton_params.h"
#include "perception/tone/tone_colour.glsl"

ENTOPTIC_MATH_BEGIN(perception::naka_rushton)

FN real log2_of(real x) { return log(x) * LIT(1.4426950408889634); }

// Response of an eye adapted to A to the luminance it is adapted to, 0..1. Jacobs gives no plateau; σ(A) = 75.57 A^(2/3), that of Hunt's cones
// (Pattanaik et al. 2000) within 0.3 % above 1 cd/m², has the form that equation 1 asks for: M = A^(n/3)/(A^(n/3) + 75.57^n).
FN real plateau(NakaRushtonParams p, real adaptation) {
    real m = real(p.plateau);
    if (!(p.plateau > 0.0f)) {
        real n = real(p.exponent);
        m = real(p.plateau_scale) / (LIT(1.0) + exp(n * (log(LIT(75.57)) - log(max(adaptation, LIT(1e-6))) / LIT(3.0))));
    }
    return clamp(m, LIT(1e-4), LIT(0.999));
}

// Equation 2: log2 of the half-saturation luminance σ = A (1/M - 1)^(1/n), cd/m².
FN real log2_half_saturation(NakaRushtonParams p, real adaptation) {
    real a = max(adaptation, LIT(1e-6));
    return log2_of(a) + log2_of(LIT(1.0) / plateau(p, a) - LIT(1.0)) / real(p.exponent);
}

// Equation 1: R = I^n/(I^n + σ^n), without overflow from 1e-7 to 1e8 cd/m².
FN real response(NakaRushtonParams p, real y, real log2_sigma) {
    return LIT(1.0) / (LIT(1.0) + exp(LIT(0.6931471805599453) * real(p.exponent) * (log2_sigma - log2_of(max(y, LIT(1e-7))))));
}

// Display luminance (cd/m²) of a response: peak times R, or the light that gives an eye adapted to the display the same response.
FN real displayed(NakaRushtonParams p, real r, real white) {
    if (!(p.display_adaptation_cd_m2 > 0.0f)) return white * r;
    real inverse = exp(LIT(0.6931471805599453) * log2_half_saturation(p, real(p.display_adaptation_cd_m2)) + log(max(r, LIT(1e-9)) / max(LIT(1.0) - r, LIT(1e-9))) / real(p.exponent));
    return min(inverse, white);
}

ENTOPTIC_MATH_END

#endif
