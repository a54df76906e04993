// Luidolt et al. 2020, equation 12: the lightness of dark pixels is blurred by a Gaussian of sigma = max(1 - L*, 0). Compiled in float
// and in double.
#ifndef ENTOPTIC_PERCEPTION_ACUITY_LUIDOLT_EQ12_MATH_GLSL
#define ENTOPTIC_PERCEPTION_ACUITY_LUIDOLT_EQ12_MATH_GLSL

#include "perception/acuity/luidolt_eq12_params.h"
#include "shaders/colour_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::luidolt_eq12)
#ifdef __cplusplus
using namespace entoptic::colour;
#endif

// Pixels per degree of the headset for which equation 12 was made: 1440 pixels over 104 degrees.
const float paper_ppd = 13.85f;
// Largest sigma, pixels: keeps the cost of a still picture of many pixels per degree finite.
const float max_sigma_px = 8.0f;
const int max_radius_px = 24;
// Luminance from which L* >= 1 and equation 12 is 0, cd/m²: 100/903.2963 (CIE's white at 100 cd/m²), rounded up.
const float sharp_cd_m2 = 0.1107057f;

FN real cube_root(real t) {
    real x = pow(t, LIT(1.0) / LIT(3.0));
    return (LIT(2.0) * x + t / (x * x)) / LIT(3.0);   // one Newton step: the precision of pow() on a GPU is poor
}

// CIE 1976 lightness of a luminance in cd/m², white 100 cd/m²; goes on above 100.
FN real lightness(real y) {
    real t = y * LIT(0.01);
    return t > LIT(216.0) / LIT(24389.0) ? LIT(116.0) * cube_root(t) - LIT(16.0) : LIT(24389.0) / LIT(27.0) * t;
}

// Inverse of lightness().
FN real luminance_of(real l) {
    real f = (l + LIT(16.0)) / LIT(116.0);
    return l > LIT(8.0) ? LIT(100.0) * f * f * f : LIT(2700.0) / LIT(24389.0) * l;
}

// Equation 12 in visual angle: sigma in pixels of a place with `ppd` pixels per degree (trap L14).
FN real blur_sigma_px(LuidoltEq12Params p, real l, real ppd) {
    return min(max(LIT(1.0) - l, LIT(0.0)) * real(p.strength) * ppd / real(paper_ppd), real(max_sigma_px));
}

// Pixels around the centre that the kernel reaches: 3 sigma. Pixel k is integrated to k + 1/2, so half a pixel less is enough.
FN int kernel_radius(real sigma_px) { return int(ceil(max(LIT(3.0) * sigma_px - LIT(0.5), LIT(0.0)))); }

// Integral of a Gaussian of sigma 1/sqrt2 from 0 to x, times 2: erf(x) for x >= 0 (Abramowitz and Stegun 7.1.26, error below 1.5e-7).
FN real error_function(real x) {
    real t = LIT(1.0) / (LIT(1.0) + LIT(0.3275911) * x);
    real tail = LIT(1.421413741) + t * (LIT(-1.453152027) + t * LIT(1.061405429));
    real poly = t * (LIT(0.254829592) + t * (LIT(-0.284496736) + t * tail));
    return LIT(1.0) - poly * exp(-x * x);
}

// Share of the Gaussian within k + 1/2 pixels of the centre. The weight of pixel k >= 1 is half of inside(k) - inside(k-1), that of the
// centre inside(0): integrated weights, exact for narrow kernels where sampled ones are not.
FN real inside_share(real sigma_px, int k) { return error_function((real(k) + LIT(0.5)) * LIT(0.7071067811865476) / sigma_px); }

// Gives a colour of luminance y the luminance y_new: ratios are kept up to a brightening of 16, the rest is added as neutral light, so
// that a black pixel beside a bright one turns grey and noise in its colour is not blown up.
FN rvec3 with_luminance(rvec3 c, real y, real y_new) {
    real gain = y_new < LIT(16.0) * y ? y_new / y : LIT(16.0);
    real rest = max(y_new - gain * y, LIT(0.0));
    return c * gain + rvec3(rest, rest, rest);
}

// CIELAB's f and its inverse, linear for dark and for negative values.
FN real lab_f(real t) { return t > LIT(216.0) / LIT(24389.0) ? cube_root(t) : (LIT(24389.0) / LIT(27.0) * t + LIT(16.0)) / LIT(116.0); }
FN real lab_f_inverse(real f) { return f > LIT(6.0) / LIT(29.0) ? f * f * f : (LIT(116.0) * f - LIT(16.0)) * LIT(27.0) / LIT(24389.0); }

// As printed: gives a linear RGB colour (cd/m², white 100) the lightness l and keeps a and b. Colours out of gamut are clamped at 0.
FN rvec3 with_lightness_in_lab(rvec3 c, real l) {
    rvec3 white = rvec3(LIT(0.95045593), LIT(1.0), LIT(1.08905775));
    rvec3 t = rvec3(LIT(0.412390799) * c.x + LIT(0.357584339) * c.y + LIT(0.180480788) * c.z,
                    LIT(0.212639006) * c.x + LIT(0.715168679) * c.y + LIT(0.0721923154) * c.z,
                    LIT(0.0193308187) * c.x + LIT(0.119194780) * c.y + LIT(0.950532152) * c.z) * LIT(0.01) / white;
    real fy = lab_f(t.y);
    real fy_new = (l + LIT(16.0)) / LIT(116.0);
    rvec3 f = rvec3(fy_new + lab_f(t.x) - fy, fy_new, fy_new + lab_f(t.z) - fy);
    rvec3 xyz = rvec3(lab_f_inverse(f.x), lab_f_inverse(f.y), lab_f_inverse(f.z)) * white * LIT(100.0);
    rvec3 rgb = rvec3(LIT(3.240969942) * xyz.x - LIT(1.537383178) * xyz.y - LIT(0.498610760) * xyz.z,
                      LIT(-0.969243636) * xyz.x + LIT(1.875967502) * xyz.y + LIT(0.0415550574) * xyz.z,
                      LIT(0.0556300797) * xyz.x - LIT(0.203976959) * xyz.y + LIT(1.056971514) * xyz.z);
    return max(rgb, rvec3(LIT(0.0), LIT(0.0), LIT(0.0)));
}

ENTOPTIC_MATH_END

#endif
