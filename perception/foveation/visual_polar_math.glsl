// Liu et al. 2021, equations 1 to 3: how densely the retina samples the visual field, and polar coordinates in which it does so evenly.
// Compiled in float and in double. Angles are eccentricities in degrees; facts/perception.md 3.6, traps Li9 and Li10.
#ifndef ENTOPTIC_PERCEPTION_FOVEATION_VISUAL_POLAR_MATH_GLSL
#define ENTOPTIC_PERCEPTION_FOVEATION_VISUAL_POLAR_MATH_GLSL

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::visual_polar)

const float fovea_deg = 5.79f;

// Equation 1: samples a degree of eccentricity, over the whole circle; up to a factor.
FN real density(real alpha_deg) {
    real d = LIT(0.3) * alpha_deg + LIT(1.0);
    return alpha_deg <= LIT(5.79) ? LIT(6.283185307179586) * alpha_deg : LIT(14.98) * LIT(3.141592653589793) * alpha_deg / (d * d);
}

// Integral of x/(0.3 x + 1)² from -1/0.3's pole of the logarithm on: (ln d + 1/d)/0.09 with d = 0.3 alpha + 1.
FN real periphery(real alpha_deg) {
    real d = LIT(0.3) * alpha_deg + LIT(1.0);
    return (log(d) + LIT(1.0) / d) / LIT(0.09);
}

// Samples within an eccentricity: the integral of equation 1, exactly. Equation 2 as printed misses the fovea's by 0.26 %.
FN real cumulated(real alpha_deg) {
    real fovea = LIT(3.141592653589793) * LIT(5.79) * LIT(5.79);
    if (alpha_deg <= LIT(5.79)) return LIT(3.141592653589793) * alpha_deg * alpha_deg;
    return fovea + LIT(14.98) * LIT(3.141592653589793) * (periphery(alpha_deg) - periphery(LIT(5.79)));
}

// Equation 2 as printed, beyond the fovea.
FN real cumulated_as_printed(real alpha_deg) {
    real d = LIT(0.3) * alpha_deg + LIT(1.0);
    return (LIT(1.0) / d + log(d)) * LIT(166.4) * LIT(3.141592653589793) - LIT(612.3);
}

// Lambert's W on its principal branch, for x in -1/e .. 0: w e^w = x. Started from the series at the branch point, then Halley's method:
// four steps reach rounding.
FN real lambert_w(real x) {
    real p = sqrt(max(LIT(2.0) * (LIT(2.718281828459045) * x + LIT(1.0)), LIT(0.0)));
    real w = LIT(-1.0) + p * (LIT(1.0) - p * (LIT(1.0) / LIT(3.0) - p * (LIT(11.0) / LIT(72.0))));
    for (int i = 0; i < 4; ++i) {
        real e = exp(w), f = w * e - x;
        real slope = e * (w + LIT(1.0));
        // At the branch point itself there is nothing to improve.
        w = w - (abs(slope) > LIT(1e-6) ? f / (slope - (w + LIT(2.0)) * f / (LIT(2.0) * w + LIT(2.0))) : LIT(0.0));
    }
    return w;
}

// Eccentricity within which `samples` lie: the inverse of cumulated(). With d = 0.3 alpha + 1, ln d + 1/d = q: v = 1/d fulfils
// -v e^(-v) = -e^(-q), so v = -W(-e^(-q)).
FN real eccentricity(real samples) {
    real fovea = LIT(3.141592653589793) * LIT(5.79) * LIT(5.79);
    if (samples <= fovea) return sqrt(max(samples, LIT(0.0)) * LIT(0.3183098861837907));
    real d = LIT(0.3) * LIT(5.79) + LIT(1.0);
    real q = (samples - fovea) * LIT(0.09) / (LIT(14.98) * LIT(3.141592653589793)) + log(d) + LIT(1.0) / d;
    return (LIT(-1.0) / lambert_w(-exp(-q)) - LIT(1.0)) / LIT(0.3);
}

// The radial coordinate 0..1 of an eccentricity in a field that ends at `edge_deg`, and back. It has the right density everywhere: linear
// in the fovea, as the paper has it, it would double the density at 5.79 degrees (trap Li10).
FN real radial(real alpha_deg, real edge_deg) { return cumulated(alpha_deg) / cumulated(edge_deg); }
FN real eccentricity_of_radial(real rho, real edge_deg) { return eccentricity(rho * cumulated(edge_deg)); }

// Equation 3 as printed: the fitted inverse for a field that ends at 80 degrees, beyond the fovea only (rho from 0.0963; trap Li9).
FN real eccentricity_fitted(real rho) {
    return (((LIT(25.09) * rho + LIT(0.1680)) * rho + LIT(27.61)) * rho + LIT(23.87)) * rho + LIT(3.232);
}

ENTOPTIC_MATH_END

#endif
