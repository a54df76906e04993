// What the panel will show of a scene luminance, as other models ask it. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_TONE_CURVE_GLSL
#define ENTOPTIC_PERCEPTION_TONE_CURVE_GLSL

#include "perception/observer_state.h"

ENTOPTIC_MATH_BEGIN(perception)

// Place of scene luminance y (cd/m²) in ToneCurve::log10_displayed, 0 .. tone_points - 1.
FN real tone_place(real y) {
    real log10_y = log(max(y, LIT(1e-6))) * LIT(0.4342944819032518);
    return clamp((log10_y + LIT(6.0)) * real(tone_points_per_decade), LIT(0.0), real(tone_points - 1u));
}

// Scene luminance of a table entry, cd/m².
FN real tone_luminance(uint i) { return exp(LIT(2.302585092994046) * (real(i) / real(tone_points_per_decade) - LIT(6.0))); }

// Displayed luminance between two entries of the table, `part` of the way from `log10_a` to `log10_b`.
FN real tone_between(real log10_a, real log10_b, real part) { return exp(LIT(2.302585092994046) * mix(log10_a, log10_b, part)); }

ENTOPTIC_MATH_END

// Displayed luminance (cd/m²) of scene luminance y: exact on the straight part, else from the table (1 % between entries), never less than
// at the end of the straight part. A macro, because GLSL would copy the table into a function.
#define ENTOPTIC_DISPLAYED_LUMINANCE(curve, y)                                                                                     \
    ((y) <= real((curve).straight_until_cd_m2)                                                                                     \
         ? (y) * real((curve).exposure)                                                                                            \
         : max(real((curve).straight_until_cd_m2) * real((curve).exposure),                                                        \
               tone_between(real((curve).log10_displayed[uint(tone_place(y))]),                                                    \
                            real((curve).log10_displayed[min(uint(tone_place(y)) + 1u, tone_points - 1u)]), fract(tone_place(y)))))

#endif
