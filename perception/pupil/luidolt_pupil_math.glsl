// Luidolt, Wimmer and Krösl 2020, section 4: the wearer's range of pupils stands for the eye's whole range. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_PUPIL_LUIDOLT_PUPIL_MATH_GLSL
#define ENTOPTIC_PERCEPTION_PUPIL_LUIDOLT_PUPIL_MATH_GLSL

#include "perception/pupil/luidolt_pupil_params.h"

ENTOPTIC_MATH_BEGIN(perception::luidolt_pupil)

// White frame -> least, black frame -> most, linear between, never beyond.
FN real simulated_mm(LuidoltPupilParams p, real measured_mm) {
    real span = real(p.black_mm) - real(p.white_mm);
    real share = abs(span) < LIT(0.05) ? LIT(0.5) : clamp((measured_mm - real(p.white_mm)) / span, LIT(0.0), LIT(1.0));
    return mix(real(p.least_mm), real(p.most_mm), share);
}

ENTOPTIC_MATH_END

#endif
