// Photon noise of rod vision: Poisson statistics of the quanta that rods absorb. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_NOISE_ROD_NOISE_MATH_GLSL
#define ENTOPTIC_PERCEPTION_NOISE_ROD_NOISE_MATH_GLSL

#include "perception/dim_light.glsl"
#include "perception/noise/rod_noise_params.h"

ENTOPTIC_MATH_BEGIN(perception::rod_noise)
#ifdef __cplusplus
using namespace dim_light;
#endif

// Quanta of 507 nm at the cornea, 1/(s deg² scotopic troland): 1/(1700 lm/W · hc/507 nm) for 1 lm/m² sr of the pupil's mm², per square degree.
const float quanta_per_troland = 4.57e5f;

// Quanta that a patch of rods absorbs within its time, from scotopic luminance (cd/m²) through a pupil (mm).
FN real absorbed_quanta(RodNoiseParams p, real scotopic, real pupil_mm) {
    real trolands = scotopic * LIT(0.7853981633974483) * pupil_mm * pupil_mm;
    return real(quanta_per_troland) * trolands * real(p.grain_deg) * real(p.grain_deg) * real(p.integration_s) * real(p.efficiency);
}

// Square of the noise's contrast to add for a place of luminances `eyes` (photopic, cd/m²): 1/n of an eye in the scene, less that which the
// wearer's eye has at the panel anyway.
FN real added_contrast2(RodNoiseParams p, BothEyes eyes, real pupil_mm) {
    real seen = LIT(1.0) / absorbed_quanta(p, real(p.sp_ratio) * eyes.scene, pupil_mm);
    if (p.photographic < 0.5) seen -= LIT(1.0) / absorbed_quanta(p, real(p.sp_ratio) * eyes.panel, pupil_mm);
    return max(seen, LIT(0.0));
}

// What light is multiplied with at a place whose noise is `normal` (mean 0, variance 1): lognormal of mean 1 and this contrast, so that it is
// never negative, and rare bright quanta in black are what is left in the deepest dark.
FN real factor(real contrast2, real normal) {
    real variance = log(LIT(1.0) + contrast2);
    return exp(sqrt(variance) * normal - LIT(0.5) * variance);
}

ENTOPTIC_MATH_END

#endif
