// What all glare models share: colour of wavelengths, diffraction by pupil and particles, tables over the angle, the split into near and
// far field, splines, the projection of the glare grid. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_GLARE_GLARE_MATH_GLSL
#define ENTOPTIC_PERCEPTION_GLARE_GLARE_MATH_GLSL

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::glare)

// --- colour ---

FN real wyman_lobe(real nm, real centre, real below, real above) {
    real t = (nm - centre) / (nm < centre ? below : above);
    return exp(LIT(-0.5) * t * t);
}

// CIE 1931 colour-matching functions, multi-lobe fit of Wyman, Sloan and Shirley 2013 (JCGT 2(2), eq. 4).
FN rvec3 wyman_xyz(real nm) {
    return rvec3(LIT(1.056) * wyman_lobe(nm, LIT(599.8), LIT(37.9), LIT(31.0)) + LIT(0.362) * wyman_lobe(nm, LIT(442.0), LIT(16.0), LIT(26.7)) -
                     LIT(0.065) * wyman_lobe(nm, LIT(501.1), LIT(20.4), LIT(26.2)),
                 LIT(0.821) * wyman_lobe(nm, LIT(568.8), LIT(46.9), LIT(40.5)) + LIT(0.286) * wyman_lobe(nm, LIT(530.9), LIT(16.3), LIT(31.1)),
                 LIT(1.217) * wyman_lobe(nm, LIT(437.0), LIT(11.8), LIT(36.0)) + LIT(0.681) * wyman_lobe(nm, LIT(459.0), LIT(26.0), LIT(13.8)));
}

// CIE XYZ to linear BT.709 (D65 white); signed, since single wavelengths lie outside the gamut (trap L9: clamp only the sum).
FN rvec3 rgb_of_xyz(rvec3 c) {
    return rvec3(LIT(3.2404542) * c.x - LIT(1.5371385) * c.y - LIT(0.4985314) * c.z,
                 LIT(-0.9692660) * c.x + LIT(1.8760108) * c.y + LIT(0.0415560) * c.z,
                 LIT(0.0556434) * c.x - LIT(0.2040259) * c.y + LIT(1.0572252) * c.z);
}

// --- diffraction ---

// J1(x)/x for x >= 0 (Abramowitz and Stegun 9.4.4 and 9.4.6, error below 4e-8).
FN real bessel_j1_over_x(real x) {
    if (x < LIT(3.0)) {
        real t = x * x / LIT(9.0);
        return LIT(0.5) + t * (LIT(-0.56249985) + t * (LIT(0.21093573) + t * (LIT(-0.03954289) +
               t * (LIT(0.00443319) + t * (LIT(-0.00031761) + t * LIT(0.00001109))))));
    }
    real t = LIT(3.0) / x;
    real amplitude = LIT(0.79788456) + t * (LIT(0.00000156) + t * (LIT(0.01659667) + t * (LIT(0.00017105) +
                     t * (LIT(-0.00249511) + t * (LIT(0.00113653) - t * LIT(0.00020033))))));
    real phase = x - LIT(2.35619449) + t * (LIT(0.12499612) + t * (LIT(0.00005650) + t * (LIT(-0.00637879) +
                 t * (LIT(0.00074348) + t * (LIT(0.00079824) - t * LIT(0.00029166))))));
    return amplitude * cos(phase) / (x * sqrt(x));
}

// Airy pattern relative to its centre, x = pi d sin(theta) / lambda.
FN real airy(real x) {
    real a = LIT(2.0) * bessel_j1_over_x(x);
    return a * a;
}

// Light scattered by one opaque disc, or passed by one hole (Babinet), per sr, of energy 1. Lengths in micrometres.
FN real disc_scatter(real diameter_um, real lambda_um, real sine) {
    real peak = LIT(0.7853981633974483) * diameter_um * diameter_um / (lambda_um * lambda_um);
    return peak * airy(LIT(3.141592653589793) * diameter_um * sine / lambda_um);
}

// Mean over its rings of the Airy pattern of a pupil, per sr: lambda / (pi^3 D sin^3 theta). The rings of a 4 mm pupil are 0.008 degrees
// apart, far below any pixel. Good to 1 % from x = pi D sin(theta)/lambda = 10 on.
FN real aperture_tail(real pupil_um, real lambda_um, real sine) {
    return lambda_um / (LIT(31.00627668029982) * pupil_um * sine * sine * sine);
}

// Share of the near field in a kernel that is not round, at the angle theta: 1 at the centre, 0 from `near` on. What is left for the coarse
// grid is the cap that theta^-3 gets inside `near` by an even polynomial that meets it at `near` with value, slope and curvature. (Round kernels are
// split by their own form: glare_split.h.)
FN real near_share(real theta, real near) {
    if (theta >= near) return LIT(0.0);
    real t = theta / near;
    real q = t * t;
    return LIT(1.0) - q * t * (LIT(4.375) - q * (LIT(5.25) - q * LIT(1.875)));
}

// Place of an angle (rad) in a radial table whose entries stand evenly in log(theta) from `first` to pi.
FN real radial_place(real theta, real first, uint entries) {
    return clamp(log(max(theta, first) / first) / log(LIT(3.141592653589793) / first), LIT(0.0), LIT(1.0)) * real(entries - 1u);
}
FN real radial_angle(real place, real first, uint entries) {
    return first * exp(log(LIT(3.141592653589793) / first) * place / real(entries - 1u));
}

// Soft end of the kernel: 1 below 0.9 radius, 0 from radius on.
FN real radius_share(real theta, real radius) {
    real t = clamp((radius - theta) / (LIT(0.1) * radius), LIT(0.0), LIT(1.0));
    return t * t * (LIT(3.0) - LIT(2.0) * t);
}

// Quadratic B-spline, by which pixels, nodes and texels exchange light. Its second moment does not depend on where between two nodes the
// light falls, as a bilinear tent's does: a lamp that moves across the grid keeps its halo. Transform sinc^3.
FN real spline(real t) {
    real a = abs(t);
    if (a < LIT(0.5)) return LIT(0.75) - a * a;
    real b = max(LIT(1.5) - a, LIT(0.0));
    return LIT(0.5) * b * b;
}
// Its weights for the node before, the nearest node, and the node after; d in [-0.5, 0.5] from the nearest.
FN rvec3 spline_weights(real d) {
    return rvec3(LIT(0.5) * (LIT(0.5) - d) * (LIT(0.5) - d), LIT(0.75) - d * d, LIT(0.5) * (LIT(0.5) + d) * (LIT(0.5) + d));
}

// The splines on the way to the grid and back, and the mean over a texel, damp a frequency f (cycles a texel) by sinc(f)^damping. This is the
// inverse of that to the power `order` of s = sin^2(pi f): a kernel sharpened by it comes out as it was meant, and as it spans 2 order + 1 texels it
// cannot ring farther out. (pi f)^2 / s = sum 2^(2k+1) s^k / ((k+1)^2 C(2k+2, k+1)), the square of the arc sine; its power damping / 2 by
// J. C. P. Miller's recurrence (Henrici 1956).
const uint most_sharpening = 8u;
FN real sharpening(real f, real damping, uint order) {
    real s = sin(LIT(3.141592653589793) * f);
    s = s * s;
    real base[most_sharpening + 1u];
    real power[most_sharpening + 1u];
    base[0] = LIT(1.0);
    power[0] = LIT(1.0);
    real sum = LIT(1.0), up = LIT(1.0);
    for (uint n = 1u; n <= order; ++n) {
        real k = real(n);
        base[n] = base[n - 1u] * (LIT(2.0) * k * k) / ((k + LIT(1.0)) * (LIT(2.0) * k + LIT(1.0)));
        real next = LIT(0.0);
        for (uint i = 1u; i <= n; ++i) next += (real(i) * (LIT(0.5) * damping + LIT(1.0)) - k) * base[i] * power[n - i];
        power[n] = next / k;
        up *= s;
        sum += power[n] * up;
    }
    return sum;
}

// --- the glare grid ---

// Azimuthal equidistant projection about `forward`: texels from the axis (right, down) of a direction. Radial angles are exact.
FN rvec2 grid_offset(rvec3 right, rvec3 up, rvec3 forward, real pitch, rvec3 direction) {
    rvec2 side = rvec2(dot(direction, right), -dot(direction, up));
    real sine = length(side);
    real theta = atan(sine, dot(direction, forward));
    return side * (sine > LIT(1e-9) ? theta / (sine * pitch) : LIT(1.0) / pitch);
}

// Zones of the view, from left to right: 0 .. zones - 1, in equal steps of horizontal angle over 90 degrees; what lies outside is of the last.
FN real zone_place(rvec3 direction, uint zones) {
    real angle = atan(direction.x, -direction.z) * LIT(0.6366197723675814);
    return clamp(angle + LIT(0.5), LIT(0.0), LIT(1.0)) * real(zones - 1u);
}
FN real zone_share(real place, uint zone) { return max(LIT(1.0) - abs(place - real(zone)), LIT(0.0)); }

// --- tone curve of the veil ---

// Kakimoto 2004, eq. 7, with the numerator x^g + 1/k of Tumblin, Hodgins and Guenter 1999 (misprint, facts 3.3 trap K3): only then is the
// ratio of the largest output to the least k^2, as the paper says. D = 640, k = 20, g = 0.465 (section 3.4). 1.6 .. 640 of 255.
FN real tumblin_sigmoid(real x) {
    real power = x > LIT(0.0) ? exp(LIT(0.465) * log(x)) : LIT(0.0);
    return LIT(640.0) * (power + LIT(0.05)) / (power + LIT(20.0));
}

// Gaussian window around the gaze; sigma 0: everywhere 1.
FN real gaze_window(rvec3 gaze, rvec3 direction, real sigma) {
    if (sigma <= LIT(0.0)) return LIT(1.0);
    real theta = atan(length(cross(gaze, direction)), dot(gaze, direction));
    return exp(LIT(-0.5) * theta * theta / (sigma * sigma));
}

ENTOPTIC_MATH_END

#endif
