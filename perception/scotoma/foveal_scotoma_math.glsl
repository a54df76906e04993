// The fovea has no rods: in the dark one does not see what one looks at. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_SCOTOMA_FOVEAL_SCOTOMA_MATH_GLSL
#define ENTOPTIC_PERCEPTION_SCOTOMA_FOVEAL_SCOTOMA_MATH_GLSL

#include "perception/dim_light.glsl"
#include "perception/scotoma/foveal_scotoma_params.h"

ENTOPTIC_MATH_BEGIN(perception::foveal_scotoma)
#ifdef __cplusplus
using namespace dim_light;
#endif

// Share of the rods that a place has, by its angle from the gaze (degrees).
FN real rods_there(FovealScotomaParams p, real eccentricity_deg) {
    real from = min(real(p.inner_deg), real(p.outer_deg)), to = max(real(p.inner_deg), real(p.outer_deg));
    real t = clamp((eccentricity_deg - from) / max(to - from, LIT(1e-6)), LIT(0.0), LIT(1.0));
    return t * t * (LIT(3.0) - LIT(2.0) * t);
}

// Share of vision that cones bear at luminance y (cd/m²): linear in log luminance over the mesopic range of CIE 191:2010, 0.005 to 5.
FN real cone_share(real y) { return clamp((log(y) * LIT(0.4342944819032518) + LIT(2.301029995663981)) / LIT(3.0), LIT(0.0), LIT(1.0)); }

// What light is multiplied with at a place of luminances `eyes` (cd/m²): the cones' part stays, the rods' is lost where there are none.
FN real factor(FovealScotomaParams p, BothEyes eyes, real eccentricity_deg, real adaptation) {
    real cones = cone_share(eyes.scene);
    if (p.photographic < 0.5) cones = residual_share(cones, cone_share(eyes.panel));
    return LIT(1.0) - real(p.strength) * dim_share(adaptation) * (LIT(1.0) - cones) * (LIT(1.0) - rods_there(p, eccentricity_deg));
}

ENTOPTIC_MATH_END

#endif
