// Krawczyk, Myszkowski and Seidel 2005: automatic key and Reinhard's global curve. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_TONE_KEY_REINHARD_MATH_GLSL
#define ENTOPTIC_PERCEPTION_TONE_KEY_REINHARD_MATH_GLSL

#include "perception/tone/key_reinhard_params.h"
#include "shaders/colour_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::key_reinhard)

// Key of a scene by its adaptation luminance A in cd/m²: 1.03 - 2/(2 + log10(A + 1)).
FN real auto_key(real adaptation) { return LIT(1.03) - LIT(2.0) / (LIT(2.0) + log(adaptation + LIT(1.0)) * LIT(0.4342944819032518)); }

// Relative display luminance 0..1 of a pixel of luminance y (cd/m²) for an eye adapted to A (cd/m², at least 1e-6: before the first
// frame the state is 0): L = key y / A, L/(1+L). As printed: L = y A, the wrong sign of trap L1.
FN real response(KeyReinhardParams p, real y, real adaptation) {
    real a = max(adaptation, LIT(1e-6));
    real scaled = real(p.key_scale) * auto_key(a) * y / a;
    if (p.as_printed > 0.5) scaled = real(p.key_scale) * y * a;
    return scaled / (LIT(1.0) + scaled);
}

// Scales a colour of luminance y to relative display luminance r, keeping its ratios; what leaves the gamut is drawn towards
// the grey of the same luminance until its largest channel is 1.
FN rvec3 scaled_colour(rvec3 c, real y, real r) {
    rvec3 out_colour = c * (r / max(y, LIT(1e-20)));
    real top = max(out_colour.x, max(out_colour.y, out_colour.z));
    if (top <= LIT(1.0)) return out_colour;
    real grey = min(r, LIT(1.0));
    real keep = (LIT(1.0) - grey) / max(top - grey, LIT(1e-20));
    return rvec3(grey, grey, grey) + (out_colour - rvec3(grey, grey, grey)) * keep;
}

ENTOPTIC_MATH_END

#endif
