// States that follow a target exponentially: steps of any length, exact for a constant target, so that two half steps are one step. Compiled
// in float and in double.
#ifndef ENTOPTIC_PERCEPTION_DECAY_GLSL
#define ENTOPTIC_PERCEPTION_DECAY_GLSL

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::decay)

const float short_step = 0.25f;  // in time constants

// 1 - exp(-x) for x >= 0 without cancellation: for short steps the series to x⁷ (relative error under 2e-9). fp32 needs it because
// 1 - exp(-1e-6) is 5 % off there and 0 at 1e-8 (oracle expm1_fp32).
FN real share_gone(real x) {
    if (x >= real(short_step)) return LIT(1.0) - exp(-x);
    real series = LIT(1.0) - x / LIT(7.0);
    series = LIT(1.0) - x / LIT(6.0) * series;
    series = LIT(1.0) - x / LIT(5.0) * series;
    series = LIT(1.0) - x / LIT(4.0) * series;
    series = LIT(1.0) - x / LIT(3.0) * series;
    return x * (LIT(1.0) - x / LIT(2.0) * series);
}

// `before` after x time constants on its way to `target`. A short step is exact as a change of the state, a long one as the rest of the way.
FN real approached(real before, real target, real x) {
    return x < real(short_step) ? before + (target - before) * share_gone(x) : target + (before - target) * exp(-x);
}

// The same for the logarithm of a state, both above 0.
FN real approached_in_log(real before, real target, real x) {
    real to_go = log(target / before);
    return x < real(short_step) ? before * exp(to_go * share_gone(x)) : target * exp(-to_go * exp(-x));
}

ENTOPTIC_MATH_END

#endif
