// What the compositor needs of the lens beyond shaders/geometry.glsl. Compiled in float by glslang and in double by g++.
#ifndef ENTOPTIC_COMPOSITOR_LENS_MATH_GLSL
#define ENTOPTIC_COMPOSITOR_LENS_MATH_GLSL

#include "shaders/geometry.glsl"

ENTOPTIC_MATH_BEGIN(lens_math)

#ifdef __cplusplus
using namespace entoptic::geometry;
#endif

// Position on the eye image (pixels of `g`) of the direction that panel position `px` (pixels of `g` too) shows in colour `c`: where the
// green lens shows that direction. As lens_pixel(g, green, lens_tangents(g, c, px)), but Newton's method starts at the radius of `px`
// itself, within a few per cent of the answer: three steps reach float precision (lens_test).
FN rvec2 green_pixel_of_colour(EyeGeometry g, LensChannel c, rvec2 px) {
    LensChannel green = g.channels[1];
    rvec2 p = lens_position(g, c, px);
    real gain = LIT(1.0) / lens_denominator(c, dot(p, p));
    rvec2 shift = rvec2(real(c.centre.x) - real(green.centre.x), real(c.centre.y) - real(green.centre.y));
    rvec2 q = p * gain + shift;
    real target = length(q);
    real r = length(p);
    for (int i = 0; i < 3; ++i) {
        real r2 = r * r;
        real f = r - target * lens_denominator(green, r2);
        real slope = LIT(1.0) - target * r * (LIT(2.0) * real(green.coefficients.x) +
                                            r2 * (LIT(4.0) * real(green.coefficients.y) + r2 * LIT(6.0) * real(green.coefficients.z)));
        r = r - f / max(slope, LIT(0.1));
    }
    rvec2 s = target > LIT(1e-12) ? q * (r / target) : q;
    rvec2 at = rvec2(s.x + real(green.centre.x), (s.y + real(green.centre.y)) * real(g.aspect));   // -1..1 across the panel
    rvec2 uv = (at + LIT(1.0)) * LIT(0.5);
    return uv * rvec2(real(g.width), real(g.height));
}

ENTOPTIC_MATH_END

#endif
