// Jacobs et al. 2015, section 2.3 and appendix A: between two luminances rods take over from cones. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_MESOPIC_JACOBS_MESOPIC_MATH_GLSL
#define ENTOPTIC_PERCEPTION_MESOPIC_JACOBS_MESOPIC_MATH_GLSL

#include "perception/mesopic/jacobs_mesopic_params.h"
#include "perception/mesopic/rod_vision_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::jacobs_mesopic)
#ifdef __cplusplus
using namespace entoptic::colour;
#endif

// Log10 luminance at which rods begin (m1) and above which only cones see (m1 > m2), of the three ranges in use.
FN rvec2 mesopic_range(JacobsMesopicParams p) {
    if (p.range < 0.5) return rvec2(LIT(0.6989700043360189), LIT(-2.301029995663981));   // CIE 191:2010: 5 and 0.005 cd/m²
    if (p.range < 1.5) return rvec2(LIT(0.0), LIT(-2.0));                                // Jacobs 2015, appendix A
    return rvec2(LIT(1.0), LIT(-3.0));                                                  // Jacobs 2015, section 2.3
}

// Equation 13, clamped: the cones' share at luminance y (cd/m²).
FN real cone_share(JacobsMesopicParams p, real y) {
    rvec2 m = mesopic_range(p);
    real rho = (log(y) * LIT(0.4342944819032518) - m.y) / (m.x - m.y);
    return clamp(rho, LIT(0.0), LIT(1.0));
}

// What rods make of a colour: appendix A's weights, which sum to 0.991, normalised so that white keeps its luminance.
FN RodVision rods(JacobsMesopicParams p) {
    rvec3 tint = rvec3(real(p.tint_r), real(p.tint_g), real(p.tint_b));
    tint /= max(luminance(tint), LIT(1e-6));
    RodVision v;
    v.weight_r = 0.0f;
    v.weight_g = float(LIT(0.8451) / LIT(0.991));
    v.weight_b = float(LIT(0.1459) / LIT(0.991));
    v.gain = 1.0f;
    v.rod_lumen = 1.0f;
    v.tint_r = float(tint.x);
    v.tint_g = float(tint.y);
    v.tint_b = float(tint.z);
    return v;
}

ENTOPTIC_MATH_END

#endif
