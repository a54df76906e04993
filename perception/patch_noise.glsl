// Noise in patches on the retina that comes and goes. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_PATCH_NOISE_GLSL
#define ENTOPTIC_PERCEPTION_PATCH_NOISE_GLSL

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::patch)

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
