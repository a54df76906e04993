// Liu et al. 2021, equations 1 to 3: how eccentricity is laid out over the radius of a foveated polar map, so that samples fall where the eye
// resolves. Compiled in float and in double. Angles in degrees, rho 0..1 from the fovea to `max_deg`.
#ifndef ENTOPTIC_PERCEPTION_FOVEATION_POLAR_MAP_MATH_GLSL
#define ENTOPTIC_PERCEPTION_FOVEATION_POLAR_MAP_MATH_GLSL

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::polar_map)

const float foveal_deg = 5.79f;      // up to here the density of samples is constant

// u = 0.3 alpha + 1; ln(u) + 1/u is the integral of equation 1 beyond the fovea, but for 14.98 pi / 0.09 and a constant.
FN real outer_part(real u) { return log(u) + LIT(1.0) / u; }
FN real outer_scale() { return LIT(522.9006438975011); }      // 14.98 pi / 0.09
FN real at_fovea_edge() { return LIT(1.3722259667775774); }   // outer_part(0.3 * 5.79 + 1)

// Integral of equation 1 from 0 to alpha: samples within alpha.
FN real samples_within(real deg) {
    if (deg <= LIT(5.79)) return LIT(3.141592653589793) * deg * deg;
    return LIT(105.31906627820958) + outer_scale() * (outer_part(LIT(0.3) * deg + LIT(1.0)) - at_fovea_edge());
}

// Inverse of samples_within() by Newton's method, from above: ln(u) <= ln(u) + 1/u.
FN real deg_of_samples(real samples) {
    if (samples <= LIT(105.31906627820958)) return sqrt(max(samples, LIT(0.0)) / LIT(3.141592653589793));
    real part = (samples - LIT(105.31906627820958)) / outer_scale() + at_fovea_edge();
    real u = exp(part);
    for (int i = 0; i < 6; ++i) u -= (outer_part(u) - part) * u * u / (u - LIT(1.0));
    return (u - LIT(1.0)) / LIT(0.3);
}

FN real exact_eccentricity_deg(real rho, real max_deg) { return deg_of_samples(rho * samples_within(max_deg)); }

// Equation 3, which fits the inverse for a map that ends at 80 degrees; another end only stretches rho. In the fovea, where it was not fitted,
// the paper maps linearly.
FN real fitted_eccentricity_deg(real rho, real max_deg) {
    real r = rho * samples_within(max_deg) / samples_within(LIT(80.0));
    real edge = LIT(105.31906627820958) / samples_within(LIT(80.0));
    if (r < edge) return LIT(5.79) * r / edge;
    return LIT(3.232) + r * (LIT(23.87) + r * (LIT(27.61) + r * (LIT(0.1680) + r * LIT(25.09))));
}

ENTOPTIC_MATH_END

#endif
