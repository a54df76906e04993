#include "perception/curves/curve_references.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace entoptic::perception::curve_reference {
namespace {

constexpr double pi = std::numbers::pi;

double parameter(const CurveInput& in, std::size_t i) { return static_cast<double>(in.parameters[i]); }
double smooth_step(double low, double high, double v) {
    const double x = std::clamp((v - low) / (high - low), 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

// Luidolt 2020, equations 3 and 4: time constant for light of Y.
double time_constant(double y, double tau_rod, double tau_cone) {
    const double s = 0.04 / (0.04 + y);
    return s * tau_rod + (1 - s) * tau_cone;
}

// CIE 1976 lightness, white 100 cd/m².
double lightness(double y) {
    const double t = y / 100;
    return t > std::pow(6.0 / 29, 3) ? 116 * std::cbrt(t) - 16 : t * std::pow(29.0 / 3, 3);
}

}  // namespace

// Watson and Yellott 2012, equations 1, 20 and 21: as 7.75 - 5.75 (F/846)^0.41 / ((F/846)^0.41 + 2).
double pupil_diameter(const CurveInput& in, double cd_m2) {
    const double age = in.own[0], flux = cd_m2 * in.own[1] * (std::lround(in.own[2]) == 1 ? 0.1 : 1), powered = std::pow(flux / 846, 0.41);
    const double young = 7.75 - 5.75 / (1 + 2 / powered), slope = 0.02132 - 0.009562 * young;
    return std::clamp(young + (age - 28.58) * slope, 1.5, 9.0);
}

// Luidolt 2020, equation 2, by the C library's expm1.
double krawczyk_exp_linear_step(const CurveInput& in, double t_s) {
    const double from = in.own[0], to = in.own[1], tau = time_constant(to, parameter(in, 2), parameter(in, 3));
    return t_s > 0 ? std::max(from - (to - from) * std::expm1(-t_s * parameter(in, 4) / tau), parameter(in, 5)) : from;
}

// The same on log10 of luminance.
double krawczyk_exp_log_step(const CurveInput& in, double t_s) {
    const double from = std::log10(in.own[0]), to = std::log10(in.own[1]), tau = time_constant(in.own[1], parameter(in, 6), parameter(in, 7));
    const double share = -std::expm1(-t_s * parameter(in, 5) / tau);
    return t_s > 0 ? std::max(std::pow(10, (1 - share) * from + share * to), parameter(in, 2)) : in.own[0];
}

// Jacobs 2015, equation 3.
double jacobs_ramp_step(const CurveInput& in, double t_s) {
    const double from = std::log10(in.own[0]), to = std::log10(in.own[1]), t = t_s * parameter(in, 5);
    const double now = from < to ? std::min(from + parameter(in, 6) * t, to) : std::max(from - parameter(in, 7) * t, to);
    return t_s > 0 ? std::max(std::pow(10, now), parameter(in, 2)) : in.own[0];
}

// Hunt 1995, Pattanaik 2000: du/dt = (1 - u)/t0 - u Y/K for the unbleached share, integrated by Runge and Kutta's method.
double pattanaik_slow_step(const CurveInput& in, double t_s) {
    const double from = in.own[0], to = in.own[1];
    const auto background = [&](double t0, double k) {
        double u = 1 / (1 + from * t0 / k);
        const double tau = 1 / (1 / t0 + to / k), time = std::min(t_s * parameter(in, 8), 40 * tau);
        const int steps = static_cast<int>(std::ceil(time / (0.02 * tau)));
        const auto slope = [&](double v) { return (1 - v) / t0 - v * to / k; };
        for (int i = 0; i < steps; ++i) {
            const double h = time / steps, a = slope(u), b = slope(u + h / 2 * a), c = slope(u + h / 2 * b), d = slope(u + h * c);
            u += h / 6 * (a + 2 * b + 2 * c + d);
        }
        return k / t0 * (1 - u) / u;
    };
    const double tau = time_constant(to, parameter(in, 6), parameter(in, 7));
    const double neural = t_s > 0 ? std::max(to * std::pow(from / to, std::exp(-t_s * parameter(in, 5) / tau)), parameter(in, 2)) : from;
    return std::max(neural, std::min(background(400, 16), background(110, 2.2e8)));
}

// Krawczyk 2005, equation 11, and Reinhard 2002, equation 3.
double key_reinhard_response(const CurveInput& in, double cd_m2) {
    const double a = in.own[0], key = parameter(in, 0) * (1.03 - 2 / (2 + std::log10(a + 1)));
    const double scaled = parameter(in, 1) > 0.5 ? parameter(in, 0) * cd_m2 * a : key / a * cd_m2;
    return 1 - 1 / (1 + scaled);
}

// Jacobs 2015, equations 1 and 2, as plain powers. Without a plateau of the user's: sigma = 75.57 A^(2/3) (Hunt's cones, Pattanaik 2000).
double naka_rushton_response(const CurveInput& in, double cd_m2) {
    const double n = parameter(in, 0), a = in.own[0], own = parameter(in, 2);
    const double m = std::clamp(own > 0 ? own : parameter(in, 1) * std::pow(a, n) / (std::pow(a, n) + std::pow(75.57 * std::pow(a, 2.0 / 3), n)), 1e-4, 0.999);
    const double sigma = a * std::pow(1 / m - 1, 1 / n), power = std::pow(std::max(cd_m2, 1e-7), n);
    return power / (power + std::pow(sigma, n));
}

// perception/tone/display_identity.md on a panel of 0.04 to 130 cd/m².
double display_identity_response(const CurveInput& in, double cd_m2) {
    const double a = in.own[0], bright = in.own[1] > 0 ? in.own[1] : 8 * a, peak = in.own[3] > 0 ? in.own[3] : bright;
    const double dark = in.own[2] >= 0 ? in.own[2] : (a < 0.04 ? 1 : 0), landing = parameter(in, 1), knee = parameter(in, 3) * 130;
    const double night = a < 1 ? std::min(std::pow(a, -parameter(in, 0)), std::max(1.0, knee / bright)) : 1;
    const double day = std::min(1.0, landing / a * std::pow(a / landing, parameter(in, 2)));
    const double e = std::pow(night, smooth_step(0.02, 0.3, dark)) * std::pow(day, smooth_step(0, 1.5, std::log2(bright / 130.52)));
    const double soft = smooth_step(0.01, 1, std::log2(e * peak / 130)), exposed = e * cd_m2, clipped = std::min(exposed, 130.0);
    if (exposed <= knee) return clipped / 130;
    return ((1 - soft) * clipped + soft * (130 - (130 - knee) * std::exp(-(exposed - knee) / (130 - knee)))) / 130;
}

// Luidolt 2020, equation 12, on a headset of 13.85 pixels per degree.
double luidolt_eq12_sigma(const CurveInput& in, double cd_m2) { return 60 / 13.85 * parameter(in, 0) * std::max(1 - lightness(cd_m2), 0.0); }
// The convention of equation 11, sigma = 1/(1.86 sqrt(2) R), but at most what 13.85 pixels per degree can show.
double luidolt_eq12_cutoff(const CurveInput& in, double cd_m2) {
    const double sigma_deg = luidolt_eq12_sigma(in, cd_m2) / 60;
    return sigma_deg > 0 ? std::min(1 / (1.86 * std::sqrt(2) * sigma_deg), 6.925) : 6.925;
}

// Larson 1997, as equation 11 of Luidolt 2020 has it.
double larson_cutoff_cpd(const CurveInput&, double cd_m2) { return 17.25 * std::atan(1.4 * std::log10(std::max(cd_m2, 1e-8)) + 0.35) + 25.72; }
// Variances add: the scene's eye's less the wearer's less that of the pixel's box.
double larson_sigma(const CurveInput& in, double cd_m2) {
    const auto variance = [&](double y) { return std::pow(60 / (1.86 * std::sqrt(2) * larson_cutoff_cpd(in, y)), 2); };
    const double missing = variance(cd_m2) - (in.own[0] > 0 ? variance(in.own[0]) : 0) - (in.own[1] > 0 ? std::pow(60 / in.own[1], 2) / 12 : 0);
    return parameter(in, 0) * std::sqrt(std::max(missing, 0.0));
}
// The same for each pixel, drawn with at most 8 pixels; pixels' boxes of 1/12 px² are part of the kernel.
double krawczyk_larson_sigma(const CurveInput& in, double cd_m2) {
    const double sigma = parameter(in, 0) * 60 / (1.86 * std::sqrt(2) * larson_cutoff_cpd(in, cd_m2)), pixel = in.own[1] > 0 ? 60 / in.own[1] : 0;
    const double drawn = std::sqrt(std::max(sigma * sigma - pixel * pixel / 12, 0.0));
    return pixel > 0 ? std::min(drawn, 8 * pixel) : drawn;
}

namespace {

// Jacobs 2015, appendix A: Gaussians of 0.75·2^(i/4) pixels at 65.5 pixels per degree; 18 thresholds, evenly over the mesopic range.
double jacobs_bands_variance(const CurveInput& in, double y) {
    constexpr double upper[] = {5, 1, 10}, lower[] = {0.005, 0.01, 0.001};
    const auto range = static_cast<std::size_t>(std::lround(parameter(in, 2)));
    const double passed = 18 * std::log(upper[range] / std::max(y, 1e-8)) / std::log(upper[range] / lower[range]);
    const double sigma = 0.75 * 60 / 65.5146 * std::pow(2, std::clamp(passed - 1, 0.0, 17.0) / 4);
    return sigma * sigma * std::clamp(passed, 0.0, 1.0);
}

}  // namespace

double jacobs_bands_cutoff(const CurveInput& in, double cd_m2) {
    const double sigma_deg = std::sqrt(jacobs_bands_variance(in, cd_m2)) / 60;
    return sigma_deg > 0 ? std::min(1 / (1.86 * std::sqrt(2) * sigma_deg), 32.75) : 32.75;
}
double jacobs_bands_sigma(const CurveInput& in, double cd_m2) {
    const double wearer = in.own[0] > 0 ? jacobs_bands_variance(in, in.own[0]) : 0;
    return parameter(in, 0) * std::sqrt(std::max(jacobs_bands_variance(in, cd_m2) - wearer, 0.0));
}

// Luidolt 2020, equation 4: 1 - s = Y/(0.04 + Y).
double luidolt_tint_cone_share(const CurveInput& in, double cd_m2) {
    double cones = cd_m2 / (0.04 + cd_m2);
    if (const double cut = parameter(in, 4); cut > 0) cones = std::min(1.0, cones * (0.04 + cut) / cut);
    return 1 - parameter(in, 0) * (1 - cones);
}
double krawczyk_tint_cone_share(const CurveInput&, double cd_m2) { return 1 - 0.04 / (0.04 + cd_m2); }

// Jacobs 2015, equation 13.
double jacobs_mesopic_cone_share(const CurveInput& in, double cd_m2) {
    constexpr double upper[] = {5, 1, 10}, lower[] = {0.005, 0.01, 0.001};
    const auto range = static_cast<std::size_t>(std::lround(parameter(in, 2)));
    return cd_m2 > 0 ? std::clamp(std::log(cd_m2 / lower[range]) / std::log(upper[range] / lower[range]), 0.0, 1.0) : 0;
}

// CIE 191:2010 with the constants of Gao 2017. For m between 0 and 1 the mesopic luminance that m belongs to is 5·1000^(m-1); the photopic
// luminance of which it is the mesopic one is then known, and grows with m: a search in m, without iterating m itself.
double mes2_cone_share(const CurveInput& in, double cd_m2) {
    const double sp = parameter(in, 2), v = 683.0 / 1700;
    const auto photopic = [&](double m) { return 5 * std::pow(1000, m - 1) * (m + (1 - m) * v) / (m + (1 - m) * sp * v); };
    if (cd_m2 >= 5) return 1;
    if (cd_m2 <= photopic(0)) return 0;
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) (photopic(0.5 * (low + high)) < cd_m2 ? low : high) = 0.5 * (low + high);
    return 0.5 * (low + high);
}

// Jacobs 2015, equations 5 and 6.
Triple jacobs_bleaching(const CurveInput& in, double t_s) {
    const double light = in.own[0], lit_s = std::min(t_s, in.own[1]), dark_s = std::max(t_s - in.own[1], 0.0);
    Triple b{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double b1 = parameter(in, 4 + i), b2 = parameter(in, 7 + i), rise = b1 * light;
        if (rise + b2 > 0) b[i] = rise / (rise + b2) * -std::expm1(-(rise + b2) * lit_s) * std::exp(-b2 * dark_s);
    }
    return b;
}

// Jacobs 2015, equations 9 and 10, over C_max = c1/c2.
double jacobs_calcium(const CurveInput& in, double t_s) {
    const double before = 1 - in.own[0], after = 1 - in.own[1];
    return after + (before - after) * std::exp(-parameter(in, 10) * t_s);
}

// Thibos 1992: refraction at a wavelength relative to 580 nm.
double thibos_defocus(const CurveInput&, double nm) { return 1.7312 - 633.46 / (nm - 214.10); }

// Liu 2021, equation 12 with a division: a lens in air before a retina at its focal length, in millimetres. Chromatic aberration adds to
// the vergence of the point.
double dioptric_disc(const CurveInput& in, double distance_m) {
    const double focal = 22.3, focus = 1000 * in.own[0], chromatic = in.own[2] > 0 ? thibos_defocus(in, in.own[2]) : 0;
    const double vergence = 1 / focal + 1 / focus - 1 / (1000 * distance_m) - chromatic / 1000, image = 1 / vergence;
    const double disc_mm = in.own[1] * std::abs(image - focal) / image, defocus = disc_mm / focal / in.own[1] * 1000, band = parameter(in, 4);
    const double seen = defocus > band ? std::sqrt((defocus - band) * (defocus + band)) : 0;
    return parameter(in, 0) * in.own[1] * 1e-3 * seen * 180 / pi;
}

// Liu 2021, equations 4, 5 and 13, in millimetres.
double liu_range_disc(const CurveInput& in, double distance_m) {
    const double f = 22.3, c = f * std::tan(pi / 180 / 60), pupil = in.own[1], focus = 1000 * in.own[0], depth = 1000 * distance_m;
    const double square = f * f, term = c * square / pupil, slope = c * f * focus / pupil, below = square + term - slope;
    const double near = square * focus / (square - term + slope), far = below > 0 ? square * focus / below : INFINITY;
    if (depth >= near && depth <= far) return 0;
    double place = std::abs((1 / focus - 1 / depth) / (1 / near - 1 / far));
    if (parameter(in, 7) > 0.5) place = std::abs((std::min(depth, 1e6) - std::min(focus, 1e6)) / (std::min(far, 1e6) - std::min(near, 5e5)));
    return 2 * parameter(in, 0) * parameter(in, 4) * std::min(place, 1.0) * 0.0722221;   // 1440 pixels on 104 degrees
}

namespace {

// Liu 2021, equation 1, integrated by Simpson's rule from 0 to alpha.
double samples_within(double alpha) {
    const auto simpson = [](double from, double to, auto&& g) {
        constexpr int n = 400;
        double sum = 0;
        for (int i = 0; i <= n; ++i) sum += (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) * g(from + (to - from) * i / n);
        return sum * (to - from) / (3 * n);
    };
    const auto fovea = [](double a) { return 2 * pi * a; };
    const auto periphery = [](double a) { return 14.98 * pi * a / std::pow(0.3 * a + 1, 2); };
    return simpson(0, std::min(alpha, 5.79), fovea) + (alpha > 5.79 ? simpson(5.79, alpha, periphery) : 0);
}

}  // namespace

// The angle within which rho of all samples fall.
double exact_eccentricity(const CurveInput& in, double rho) {
    const double wanted = rho * samples_within(in.own[0]);
    double low = 0, high = in.own[0];
    for (int i = 0; i < 60; ++i) (samples_within(0.5 * (low + high)) < wanted ? low : high) = 0.5 * (low + high);
    return 0.5 * (low + high);
}

// Liu 2021, equation 3; linear in the fovea.
double fitted_eccentricity(const CurveInput& in, double rho) {
    const double r = rho * samples_within(in.own[0]) / samples_within(80), edge = samples_within(5.79) / samples_within(80);
    return r < edge ? 5.79 * r / edge : 25.09 * std::pow(r, 4) + 0.1680 * std::pow(r, 3) + 27.61 * r * r + 23.87 * r + 3.232;
}

}  // namespace entoptic::perception::curve_reference
