// References of the curves of the slot `glare`: Bessel functions of the standard library, rings by their encircled energy.
#include "perception/curves/curve_references.h"
#include "perception/glare/glare_reference.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace entoptic::perception::curve_reference {
namespace {

using glare_reference::Wave;

constexpr double pi = std::numbers::pi, degree = pi / 180;

double parameter(const CurveInput& in, std::size_t i) { return static_cast<double>(in.parameters[i]); }
double smooth(double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

struct Line {
    double nm, weight;
};
// Luminance of light of equal energy.
std::vector<Line> lines(double wavelength_nm) {
    if (wavelength_nm > 0) return {{wavelength_nm, 1}};
    std::vector<Line> list;
    for (const Wave& w : glare_reference::white_spectrum()) list.push_back({w.nm, 0.2126 * w.weight[0] + 0.7152 * w.weight[1] + 0.0722 * w.weight[2]});
    return list;
}

// Over the sphere, angles in degrees, by the trapezoidal rule in log(angle).
double over_sphere(double from, double to, const std::function<double(double)>& per_sr) {
    constexpr int n = 3000;
    const double step = std::log(to / from) / n;
    double sum = 0;
    for (int i = 0; i <= n; ++i) {
        const double deg = from * std::exp(i * step);
        sum += (i == 0 || i == n ? 0.5 : 1) * per_sr(deg) * 2 * pi * std::sin(deg * degree) * deg * degree * step;
    }
    return sum;
}

// Rayleigh 1881: share of a disc's diffracted light outside x = pi d sin(theta) / lambda; beyond 200 by its mean over the fringes.
constexpr double many_fringes = 200;
double outside_by_mean(double x) { return 2 / (pi * x); }
double outside(double x) { return x > many_fringes ? outside_by_mean(x) : std::pow(std::cyl_bessel_j(0.0, x), 2) + std::pow(std::cyl_bessel_j(1.0, x), 2); }
// Between two angles, both by the same formula: their difference is small beside what the formulas differ by.
double between(double low, double high) { return high > many_fringes ? outside_by_mean(low) - outside_by_mean(high) : outside(low) - outside(high); }

// A pupil's diffraction per sr as a mean over the ring of one fringe; within its third dark ring the pattern itself.
constexpr double third_dark_ring = 10.173468135062722;
double pupil_x(double pupil_mm, double nm, double deg) { return pi * pupil_mm * 1e6 * std::sin(deg * degree) / nm; }
double rings(double pupil_mm, double nm, double deg) {
    const double x = pupil_x(pupil_mm, nm, deg), low = x - pi / 2, high = x + pi / 2, scale = pupil_x(pupil_mm, nm, 90);
    if (x < third_dark_ring) return 0;
    return between(low, high) / (pi * (high * high - low * low)) * scale * scale;
}
double core(double pupil_mm, double nm, double deg) {
    const double energy = 1 - std::pow(std::cyl_bessel_j(0.0, third_dark_ring), 2);
    return pupil_x(pupil_mm, nm, deg) < third_dark_ring ? glare_reference::disc(pupil_mm * 1e3, nm * 1e-3, deg * degree) / energy : 0;
}

struct Optics {
    double pupil_mm, particle_um, covered, diffraction;
    double fibres = 0;

    double scattered(double nm, double deg) const {
        const double inner = std::min(deg, 90.0), d = deg - 3 * nm / 568;
        return (1 - covered) * diffraction * rings(pupil_mm, nm, inner) + covered * glare_reference::disc(particle_um, nm * 1e-3, inner * degree) +
               fibres * 436.9 * 568 / nm * std::exp(-19.75 * d * d);
    }
    // Energies by Rayleigh's formula.
    double beyond(double nm, double deg) const {
        return (1 - covered) * diffraction * outside(pupil_x(pupil_mm, nm, deg)) + covered * outside(pupil_x(particle_um * 1e-3, nm, deg));
    }
    double all(double nm) const {
        const auto fibre_ring = [&](double deg) { return fibres * 436.9 * 568 / nm * std::exp(-19.75 * std::pow(deg - 3 * nm / 568, 2)); };
        const double ring = fibres > 0 ? over_sphere(1e-3, 90, fibre_ring) : 0;
        const double tail = (1 - covered) * diffraction * (outside(third_dark_ring) - outside(pupil_x(pupil_mm, nm, 90)));
        return tail + covered * (1 - outside(pupil_x(particle_um * 1e-3, nm, 90))) + ring;
    }
};

std::vector<double> psf(const Optics& optics, double wavelength_nm, std::span<const double> degrees, const std::function<double(double nm, double deg)>& straylight) {
    const std::vector<Line> spectrum = lines(wavelength_nm);
    double direct = 1;
    // Straylight has one shape at all wavelengths.
    const double shape = over_sphere(1e-4, 90, [&](double deg) { return straylight(spectrum[0].nm, deg); }), unit = straylight(spectrum[0].nm, 1);
    for (const Line& l : spectrum) direct -= l.weight * (optics.all(l.nm) + (unit > 0 ? shape * straylight(l.nm, 1) / unit : 0));
    std::vector<double> values;
    for (const double deg : degrees) {
        double sum = 0;
        for (const Line& l : spectrum)
            sum += l.weight * (std::max(direct, 0.0) * core(optics.pupil_mm, l.nm, deg) + optics.scattered(l.nm, deg) + straylight(l.nm, deg));
        values.push_back(sum);
    }
    return values;
}

double covered_share(double per_mm2, double diameter_um) { return 1 - std::exp(-per_mm2 * pi / 4 * std::pow(diameter_um * 1e-3, 2)); }

}  // namespace

// Luidolt 2020, section 4.2: pupil and particles, by Babinet's principle.
std::vector<double> luidolt_spectral_scatter(const CurveInput& in, std::span<const double> degrees) {
    const Optics optics{in.own[0], parameter(in, 1), covered_share(parameter(in, 2), parameter(in, 1)), parameter(in, 4)};
    return psf(optics, in.own[1], degrees, [](double, double) { return 0.0; });
}

// CIE 146-2002, general disability glare, with particles, pupil and Spencer's ring (1995).
std::vector<double> closed_form_scatter(const CurveInput& in, std::span<const double> degrees) {
    const double age = parameter(in, 1), pigment = parameter(in, 2), factor = parameter(in, 3), blue = parameter(in, 8);
    Optics optics{in.own[0], parameter(in, 4), covered_share(parameter(in, 5), parameter(in, 4)), parameter(in, 6)};
    const auto veil = [&](double angle) {
        const double deg = std::clamp(angle, 0.1, 100.0), a = 1 + std::pow(age / 62.5, 4);
        const double cie = 10 / std::pow(deg, 3) + (5 / (deg * deg) + 0.1 * pigment / deg) * a + 0.0025 * pigment;
        return cie * (1 + (factor - 1) * smooth(std::log10(deg / 0.1))) * smooth((110 - angle) / 10);
    };
    const auto colour = [&](double nm) { return 1 + blue * (1 - std::min(pigment / 1.2, 1.0)) * (std::pow(575 / nm, 4) - 1); };
    Optics mean = optics;
    mean.pupil_mm = 4;
    double luminance = 0, others = 0;
    for (const Line& l : lines(0)) luminance += l.weight * colour(l.nm), others += l.weight * mean.beyond(l.nm, 1);
    const double left = std::max(1 - others / over_sphere(1, 180, veil), 0.0);
    optics.fibres = 0.033 * parameter(in, 7) * std::clamp((in.own[0] - 1.9) / 3, 0.0, 1.0);
    return psf(optics, in.own[1], degrees, [&](double nm, double deg) { return left * veil(deg) * colour(nm) / luminance; });
}

// CIE 135/1-1999, equation 8, over its integral.
std::vector<double> cie135_scatter(const CurveInput& in, std::span<const double> degrees) {
    const double a = std::pow(parameter(in, 1) / 70, 4), p = parameter(in, 2);
    const auto total = [&](double t) {
        const auto moffat = [&](double width, double power) { return std::pow(1 + std::pow(t / width, 2), -power); };
        return (1 - 0.08 * a) * (9.2e6 * moffat(0.0046, 1.5) + 1.5e5 * moffat(0.045, 1.5)) +
               (1 + 1.6 * a) * (400 * moffat(0.1, 1) + 3e-8 * t * t + p * (1300 * moffat(0.1, 1.5) + 0.8 * moffat(0.1, 0.5))) + 2.5e-3 * p;
    };
    const double sum = over_sphere(1e-6, 90, total);
    std::vector<double> values;
    for (const double deg : degrees) values.push_back(total(deg) / sum);
    return values;
}

}  // namespace entoptic::perception::curve_reference
