// What tone maps share: the colour of a pixel whose displayed luminance is known. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_TONE_TONE_COLOUR_GLSL
#define ENTOPTIC_PERCEPTION_TONE_TONE_COLOUR_GLSL

#include "shaders/colour_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::tone)

// Scales a colour of luminance y to luminance t with the same ratios; what has a channel above `white` is drawn towards the grey of
// luminance min(t, white) until its largest channel is `white`. All in cd/m².
FN rvec3 displayed_colour(rvec3 c, real y, real t, real white) {
    rvec3 scaled = c * (t / max(y, LIT(1e-20)));
    real top = max(scaled.x, max(scaled.y, scaled.z));
    if (top <= white) return scaled;
    real grey = min(t, white);
    real keep = (white - grey) / max(top - grey, LIT(1e-20));
    return min(rvec3(grey, grey, grey) + (scaled - rvec3(grey, grey, grey)) * keep, rvec3(white, white, white));
}

ENTOPTIC_MATH_END

#endif
