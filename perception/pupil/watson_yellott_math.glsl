// Watson and Yellott 2012: the unified formula for light-adapted pupil size. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_PUPIL_WATSON_YELLOTT_MATH_GLSL
#define ENTOPTIC_PERCEPTION_PUPIL_WATSON_YELLOTT_MATH_GLSL

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::watson_yellott)

// Pupil of the reference age of 28.58 years, mm, for an effective flux density: luminance times area of the adapting field times
// monocular factor, cd/m² deg² (Stanley and Davies 1995).
FN real reference_diameter_mm(real flux) {
    real x = flux > LIT(0.0) ? pow(flux / LIT(846.0), LIT(0.41)) : LIT(0.0);
    return LIT(7.75) - LIT(5.75) * x / (x + LIT(2.0));
}

// Diameter of the entrance pupil, mm, at `age` years.
FN real diameter_mm(real flux, real age) {
    real reference = reference_diameter_mm(flux);
    return reference + (age - LIT(28.58)) * (LIT(0.02132) - LIT(0.009562) * reference);
}

ENTOPTIC_MATH_END

#endif
