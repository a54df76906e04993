// CIE 191:2010, the recommended system of mesopic photometry (MES2). Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_MESOPIC_MES2_MATH_GLSL
#define ENTOPTIC_PERCEPTION_MESOPIC_MES2_MATH_GLSL

#include "perception/mesopic/mes2_params.h"
#include "perception/mesopic/rod_vision_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::mes2)
#ifdef __cplusplus
using namespace entoptic::colour;
#endif

// V'(555 nm): 683 lm/W over 1700 lm/W, by which scotopic light counts against photopic.
FN real rod_lumen() { return LIT(683.0) / LIT(1700.0); }

// Mesopic luminance of photopic and scotopic luminances (cd/m²) at the adaptation coefficient m.
FN real mesopic_luminance(real m, real photopic, real scotopic) {
    real rods = (LIT(1.0) - m) * rod_lumen();
    return (m * photopic + rods * scotopic) / (m + rods);
}

// m = a + b·log10 Lmes, clamped, with a = 1 - log10(5)/3 and b = 1/3 (Gao et al. 2017): 0 at 0.005, 1 at 5 cd/m².
FN real coefficient(real mesopic) { return clamp(LIT(0.7670099985546605) + log(mesopic) * LIT(0.14476482730108395), LIT(0.0), LIT(1.0)); }

// The adaptation coefficient of a field: the root of m = coefficient(mesopic_luminance(m)), kept between two ends, since the fixed-point
// iteration of CIE 191 need not converge for extreme ratios of scotopic to photopic light. Regula falsi by the Illinois rule.
FN real adaptation_coefficient(real photopic, real scotopic) {
    if (coefficient(photopic) >= LIT(1.0)) return LIT(1.0);
    if (coefficient(scotopic) <= LIT(0.0)) return LIT(0.0);
    real low = LIT(0.0), high = LIT(1.0);
    real at_low = -coefficient(scotopic), at_high = LIT(1.0) - coefficient(photopic);
    real m = low;
    for (int i = 0; i < 30; ++i) {
        m = (low * at_high - high * at_low) / (at_high - at_low);
        real excess = m - coefficient(mesopic_luminance(m, photopic, scotopic));
        if (abs(excess) < LIT(2e-7)) break;
        if (excess < LIT(0.0)) {
            low = m;
            at_low = excess;
            at_high *= LIT(0.5);
        } else {
            high = m;
            at_high = excess;
            at_low *= LIT(0.5);
        }
    }
    return m;
}

// Cones' share of an eye adapted to luminance y (cd/m²).
FN real cone_share(Mes2Params p, real y) { return adaptation_coefficient(y, real(p.sp_ratio) * y); }

// Scotopic luminance of the display's primaries, for white equal to its photopic luminance (from CIE 1951 V' and a smooth basis of
// emission spectra that add up to D65), and what daylight has more: S/P = 2.4645.
FN RodVision rods(Mes2Params p) {
    rvec3 tint = rvec3(real(p.tint_r), real(p.tint_g), real(p.tint_b));
    tint /= max(luminance(tint), LIT(1e-6));
    RodVision v;
    v.weight_r = 0.0153f;
    v.weight_g = 0.5951f;
    v.weight_b = 0.3896f;
    v.gain = float(LIT(2.4645) * rod_lumen());
    v.rod_lumen = float(rod_lumen());
    v.tint_r = float(tint.x);
    v.tint_g = float(tint.y);
    v.tint_b = float(tint.z);
    return v;
}

ENTOPTIC_MATH_END

#endif
