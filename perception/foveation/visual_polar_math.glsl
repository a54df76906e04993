// Liu et al. 2021, equations 1 to 3, beside what the geometry of a foveated eye image has of them (shaders/visual_polar_math.glsl): the
// density itself, the equations as printed, and the radius of the paper's polar map. Compiled in float and in double. Angles are
// eccentricities in degrees.
#ifndef ENTOPTIC_PERCEPTION_FOVEATION_VISUAL_POLAR_MATH_GLSL
#define ENTOPTIC_PERCEPTION_FOVEATION_VISUAL_POLAR_MATH_GLSL

#include "shaders/visual_polar_math.glsl"

ENTOPTIC_MATH_BEGIN(visual_polar)

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

// polar_eccentricity() in closed form. With d = 0.3 alpha + 1, ln d + 1/d = q: v = 1/d fulfils -v e^(-v) = -e^(-q), so v = -W(-e^(-q)).
FN real eccentricity_by_lambert_w(real samples) {
    if (samples <= polar_samples_of_fovea()) return sqrt(max(samples, LIT(0.0)) * LIT(0.3183098861837907));
    real q = LIT(0.09) * ((samples - polar_samples_of_fovea()) / LIT(47.0610579507751) + polar_periphery(LIT(5.79)));
    return (LIT(-1.0) / lambert_w(-exp(-q)) - LIT(1.0)) / LIT(0.3);
}

// Equation 2 as printed, beyond the fovea.
FN real cumulated_as_printed(real alpha_deg) {
    real d = LIT(0.3) * alpha_deg + LIT(1.0);
    return (LIT(1.0) / d + log(d)) * LIT(166.4) * LIT(3.141592653589793) - LIT(612.3);
}

// The radial coordinate 0..1 of an eccentricity in a field that ends at `edge_deg`, and back. It has the right density everywhere: linear
// in the fovea, as the paper has it, it would double the density at 5.79 degrees (trap Li10).
FN real radial(real alpha_deg, real edge_deg) { return polar_samples(alpha_deg) / polar_samples(edge_deg); }
FN real eccentricity_of_radial(real rho, real edge_deg) { return polar_eccentricity(rho * polar_samples(edge_deg)); }

// Equation 3 for a map that ends at `edge_deg`, which only stretches rho. In the fovea, where it was not fitted, the paper maps linearly.
FN real fitted_eccentricity_of_radial(real rho, real edge_deg) {
    real r = rho * polar_samples(edge_deg) / polar_samples_of_fit();
    real edge = polar_samples_of_fovea() / polar_samples_of_fit();
    return r < edge ? LIT(5.79) * r / edge : polar_equation_3(r);
}

ENTOPTIC_MATH_END

#endif
