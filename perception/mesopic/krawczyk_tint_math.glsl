// Krawczyk, Myszkowski and Seidel 2005: each pixel of display light goes over into one bluish-purple tint by the rods' share at its own
// scene luminance. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_MESOPIC_KRAWCZYK_TINT_MATH_GLSL
#define ENTOPTIC_PERCEPTION_MESOPIC_KRAWCZYK_TINT_MATH_GLSL

#include "perception/mesopic/krawczyk_tint_params.h"
#include "perception/residual.glsl"
#include "perception/tone_curve.glsl"
#include "shaders/colour_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::krawczyk_tint)
#ifdef __cplusplus
using namespace entoptic::colour;
#endif

// Cones' share at luminance y (cd/m²): 1 - 0.04/(0.04 + y), equation 4 of Luidolt 2020 (after Hunt 1995).
FN real cone_share(real y) { return y / (LIT(0.04) + y); }

// Rods' share to simulate of a pixel whose scene and displayed luminance these are.
FN real rod_share(KrawczykTintParams p, BothEyes eyes) {
    real cones = cone_share(eyes.scene);
    if (p.photographic < 0.5) cones = residual_share(cones, cone_share(eyes.panel));
    return real(p.strength) * (LIT(1.0) - cones);
}

FN rvec3 tint(KrawczykTintParams p) {
    rvec3 t = rvec3(real(p.tint_r), real(p.tint_g), real(p.tint_b));
    return t / max(luminance(t), LIT(1e-6));
}

// Equation 14 on light above the display's black, cd/m².
FN rvec3 tinted(rvec3 rgb, rvec3 tint_colour, real share) { return rgb * (LIT(1.0) - share) + tint_colour * (luminance(rgb) * share); }

// Largest change of any displayed 8-bit sRGB code by a rods' share: see bound_codes() of luidolt_tint. Upwards a channel changes by at most
// share·(t·(1 - w)) of the display's range, and the sRGB curve is steepest at black.
FN real bound_codes(KrawczykTintParams p, real share) {
    rvec3 t = tint(p);
    real up = max(t.x * LIT(0.7874), max(t.y * LIT(0.2848), t.z * LIT(0.9278)));
    return share * LIT(255.0) * max(LIT(12.92) * up, LIT(1.0));
}

ENTOPTIC_MATH_END

#endif
