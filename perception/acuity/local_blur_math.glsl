// A Gaussian blur whose width follows the picture slowly. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_ACUITY_LOCAL_BLUR_MATH_GLSL
#define ENTOPTIC_PERCEPTION_ACUITY_LOCAL_BLUR_MATH_GLSL

#include "perception/patch_noise.glsl"
#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::local_blur)
#ifdef __cplusplus
using namespace patch;
#endif

// What a model's added_variance() may ask of a place.
struct BlurPlace {
    real noise;              // normal, in patches; 0 without randomness
    real eccentricity_deg;   // angle from the gaze
    real ppd;                // pixels per degree
};

// Largest variance of a blur (px²): the kernel then reaches max_blur_radius. 36 pixels are 36 arcminutes at 60 pixels per degree, wider
// than any acuity curve asks for; beyond, still pictures of many pixels per degree keep a finite cost.
const float max_variance_px2 = 1296.0f;
const int max_blur_radius = 127;

// Pixels that a kernel of this variance (px²) reaches on each side: 3.5 sigma.
FN int blur_radius(real variance) { return int(ceil(LIT(3.5) * sqrt(variance) + LIT(0.5))); }

// The kernel is the discrete Gaussian exp(-t)·I_n(t) of variance t px² (Lindeberg 1990): its variance is exactly t, however narrow it is,
// and two in a row are one of the sum. From the recurrence of the modified Bessel functions, I_(n-1) = I_(n+1) + 2n/t·I_n, which is stable
// downwards: begin beyond the kernel's end with (0, 1), divide by the sum. No exponentials, no tables.
FN real inner_weight(real weight, real outer, int n, real variance) { return outer + LIT(2.0) * real(n) / variance * weight; }

ENTOPTIC_MATH_END

#endif
