// A Gaussian blur whose width follows the picture slowly, and noise in patches. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_ACUITY_LOCAL_BLUR_MATH_GLSL
#define ENTOPTIC_PERCEPTION_ACUITY_LOCAL_BLUR_MATH_GLSL

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::local_blur)

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

// 32-bit mixing: the finaliser of MurmurHash3 (Appleby, public domain).
FN uint mixed(uint x) {
    x = (x ^ (x >> 16)) * 0x85ebca6bu;
    x = (x ^ (x >> 13)) * 0xc2b2ae35u;
    return x ^ (x >> 16);
}

// A standard normal number for a place of a lattice and a tick of the clock (Box and Muller 1958).
FN real lattice_normal(uint seed, int x, int y, uint tick) {
    uint h = mixed((mixed((mixed(seed ^ uint(x)) + 0x9e3779b9u) ^ uint(y)) + 0x9e3779b9u) ^ tick);
    real u = (real(h >> 8) + LIT(0.5)) / LIT(16777216.0);
    real v = real(mixed(h ^ 0x68bc21ebu) >> 8) / LIT(16777216.0);
    return sqrt(LIT(-2.0) * log(u)) * cos(LIT(6.283185307179586) * v);
}

FN real smooth_part(real x) { return x * x * (LIT(3.0) - LIT(2.0) * x); }

// Normal noise that varies smoothly over cells of a lattice and over ticks: mean 0 and variance 1 at every place and time, because the
// interpolated sum is divided by the root of its weights' squares. Within ±4.
FN real patch_noise(uint seed, rvec2 at, uint tick, real part) {
    rvec2 corner = floor(at);
    rvec2 along = at - corner;
    rvec2 w = rvec2(smooth_part(along.x), smooth_part(along.y));
    real later = smooth_part(part);
    real sum = LIT(0.0), squares = LIT(0.0);
    for (int i = 0; i < 8; ++i) {
        real weight = ((i & 1) == 1 ? w.x : LIT(1.0) - w.x) * ((i & 2) == 2 ? w.y : LIT(1.0) - w.y) * ((i & 4) == 4 ? later : LIT(1.0) - later);
        sum += weight * lattice_normal(seed, int(corner.x) + (i & 1), int(corner.y) + ((i >> 1) & 1), tick + uint((i >> 2) & 1));
        squares += weight * weight;
    }
    return clamp(sum / sqrt(squares), LIT(-4.0), LIT(4.0));
}

// Place of a direction on the lattice: longitude and latitude from the gaze, in cells.
FN rvec2 lattice_place(rvec3 direction, rvec3 gaze, real cell_deg) {
    real longitude = atan(direction.x, -direction.z) - atan(gaze.x, -gaze.z);
    real latitude = asin(clamp(direction.y, LIT(-1.0), LIT(1.0))) - asin(clamp(gaze.y, LIT(-1.0), LIT(1.0)));
    return rvec2(longitude, latitude) * (LIT(57.29577951308232) / cell_deg);
}

ENTOPTIC_MATH_END

#endif
