// When what only rods show may be seen. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_DIM_LIGHT_GLSL
#define ENTOPTIC_PERCEPTION_DIM_LIGHT_GLSL

#include "perception/observer_state.h"
#include "perception/residual.glsl"
#include "perception/tone_curve.glsl"

ENTOPTIC_MATH_BEGIN(perception::dim_light)

// Adaptation luminance from which there is nothing of it, and below which there is all, cd/m². choice: above 0.1 the noise's contrast in
// patches of half a degree is under 2 %, and cones see.
const float no_rods_alone_cd_m2 = 0.1f, rods_alone_cd_m2 = 0.03f;

// 1 in the dark, 0 from 0.1 cd/m² on, smooth in log luminance between.
FN real dim_share(real adaptation) {
    if (adaptation >= real(no_rods_alone_cd_m2)) return LIT(0.0);
    if (adaptation <= real(rods_alone_cd_m2)) return LIT(1.0);
    real t = log(real(no_rods_alone_cd_m2) / adaptation) / log(real(no_rods_alone_cd_m2) / real(rods_alone_cd_m2));
    return t * t * (LIT(3.0) - LIT(2.0) * t);
}

ENTOPTIC_MATH_END

// Whether the tone curve shows any luminance brighter than it is, so that an eye at the panel lacks something of an eye in the scene. A macro,
// because GLSL would copy the curve into a function; the entries decide, since the curve is a line between them over log luminance.
#define ENTOPTIC_TONE_BRIGHTENS(curve, brightens) \
    brightens = (curve).exposure > 1.0; \
    for (uint tone_entry = 0u; tone_entry < tone_points && !brightens; ++tone_entry) \
        brightens = tone_luminance(tone_entry) > (curve).straight_until_cd_m2 && \
                    exp(2.302585092994046 * (curve).log10_displayed[tone_entry]) > tone_luminance(tone_entry) * 1.00001

#endif
