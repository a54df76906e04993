// How densely the retina samples the visual field (Liu et al. 2021, equation 1), integrated and inverted: the part that the geometry of a
// foveated eye image needs. Compiled in float and in double. Angles are eccentricities in degrees; facts/perception.md 3.6, traps Li9, Li10.
#ifndef ENTOPTIC_SHADERS_VISUAL_POLAR_MATH_GLSL
#define ENTOPTIC_SHADERS_VISUAL_POLAR_MATH_GLSL

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(visual_polar)

// Samples within the fovea, pi 5.79², and within 80 degrees, where equation 3 was fitted.
FN real polar_samples_of_fovea() { return LIT(105.31906627820958); }
FN real polar_samples_of_fit() { return LIT(1091.8494918829258); }

// Integral of x/(0.3 x + 1)² from -1/0.3's pole of the logarithm on: (ln d + 1/d)/0.09 with d = 0.3 alpha + 1.
FN real polar_periphery(real alpha_deg) {
    real d = LIT(0.3) * alpha_deg + LIT(1.0);
    return (log(d) + LIT(1.0) / d) / LIT(0.09);
}

// Samples within an eccentricity: the integral of equation 1, exactly. Equation 2 as printed misses the fovea's by 0.26 %.
FN real polar_samples(real alpha_deg) {
    if (alpha_deg <= LIT(5.79)) return LIT(3.141592653589793) * alpha_deg * alpha_deg;
    return polar_samples_of_fovea() + LIT(47.0610579507751) * (polar_periphery(alpha_deg) - LIT(15.246955186417527));
}

// Equation 1: samples a degree of eccentricity, over the whole circle; up to a factor.
FN real polar_density(real alpha_deg) {
    real d = LIT(0.3) * alpha_deg + LIT(1.0);
    return alpha_deg <= LIT(5.79) ? LIT(6.283185307179586) * alpha_deg : LIT(47.0610579507751) * alpha_deg / (d * d);
}

// Equation 3 as printed: the fitted inverse for a field that ends at 80 degrees, beyond the fovea only (rho from 0.0963; trap Li9).
FN real polar_equation_3(real rho) {
    return (((LIT(25.09) * rho + LIT(0.1680)) * rho + LIT(27.61)) * rho + LIT(23.87)) * rho + LIT(3.232);
}

// Steps of Newton's method below that reach rounding: from 0.03 degrees, as far as equation 3 was fitted.
#ifdef __cplusplus
const int polar_newton_steps = 4;
#else
const int polar_newton_steps = 2;
#endif

// Eccentricity within which `samples` lie, up to 180 degrees: the inverse of polar_samples(). Newton's method from equation 3.
FN real polar_eccentricity(real samples) {
    if (samples <= polar_samples_of_fovea()) return sqrt(max(samples, LIT(0.0)) * LIT(0.3183098861837907));
    real alpha = polar_equation_3(samples / polar_samples_of_fit());
    for (int i = 0; i < polar_newton_steps; ++i) alpha = max(alpha - (polar_samples(alpha) - samples) / polar_density(alpha), LIT(5.79));
    return alpha;
}

// polar_eccentricity() by equation 3. In the fovea, where equation 3 was not fitted, exactly.
FN real polar_eccentricity_fitted(real samples) {
    if (samples <= polar_samples_of_fovea()) return polar_eccentricity(samples);
    return polar_equation_3(samples / polar_samples_of_fit());
}

ENTOPTIC_MATH_END

#endif
