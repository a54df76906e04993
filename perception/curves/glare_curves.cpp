// Curves of the slot `glare`.
#include "perception/curves/curve_references.h"
#include "perception/curves/curve_table.h"
#include "perception/curves/glare_psf.glsl"
#include "perception/glare/cie135_math.glsl"
#include "perception/glare/cie135_params.h"
#include "perception/glare/closed_form_params.h"
#include "perception/glare/glare_spectrum.h"
#include "perception/glare/luidolt_spectral_params.h"

#include "perception/curves/glare_psf_cie135.comp.h"
#include "perception/curves/glare_psf_closed_form.comp.h"
#include "perception/curves/glare_psf_luidolt_spectral.comp.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

using glare_psf::WaveOptics;

constexpr double pi = 3.14159265358979323846, degree = pi / 180;

// Integral of a function of the angle (deg) over the sphere between two angles, in steps of its logarithm.
template <class F> double scattered(double from_deg, double to_deg, F&& per_sr) {
    constexpr int steps = 4000;
    const double ratio = std::log(to_deg / from_deg);
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double deg = from_deg * std::exp(ratio * (i + 0.5) / steps);
        sum += per_sr(deg) * std::sin(deg * degree) * deg;
    }
    return sum * 2 * pi * degree * ratio / steps;
}

// One wavelength of light of equal energy at all wavelengths, as luminance.
struct Wave {
    double um, weight;
    double straylight = 0;    // what straylight is multiplied by
};

std::vector<Wave> waves_of(double wavelength_nm) {
    if (wavelength_nm > 0) return {{wavelength_nm / 1000, 1}};
    const GlareSpectrum spectrum = midpoint_spectrum(table_wavelengths);
    std::vector<Wave> waves;
    for (std::size_t i = 0; i < spectrum.nm.size(); ++i)
        waves.push_back({spectrum.nm[i] / 1000, glm::dot(glm::dvec3(0.2126, 0.7152, 0.0722), spectrum.weight[i])});
    return waves;
}

double covered(double diameter_um, double per_mm2) { return -std::expm1(-per_mm2 * pi / 4 * 1e-6 * diameter_um * diameter_um); }

template <class P> WaveOptics optics_of(const P& p, double pupil_mm) {
    const auto diameter = static_cast<double>(p.particle_diameter_um);
    return {pupil_mm, diameter, covered(diameter, static_cast<double>(p.particles_per_mm2)), static_cast<double>(p.diffraction), 0, 0};
}

double straylight_at(const ClosedFormParams& p, double deg) {
    return closed_form::straylight(deg, static_cast<double>(p.age), static_cast<double>(p.pigment), static_cast<double>(p.straylight_factor));
}

// What the pupil does not send straight on, as a share of all light.
double not_direct(const std::vector<Wave>& waves, const WaveOptics& w, double straylight) {
    double sum = 0;
    for (const Wave& wave : waves) {
        const double core_deg = std::asin(glare_psf::core_end() * wave.um / (1e3 * pi * w.pupil_mm)) / degree;
        const auto all = [&](double deg) { return glare_psf::scattered_light(w, wave.um, std::sin(deg * degree), deg); };
        sum += wave.weight * (scattered(1e-4, core_deg, all) + scattered(core_deg * (1 + 1e-12), 90, all) + wave.straylight * straylight);
    }
    return sum;
}

std::vector<float> table_of(const std::vector<Wave>& waves, const WaveOptics& w, double straylight) {
    std::vector<float> table{static_cast<float>(waves.size()), static_cast<float>(std::max(1 - not_direct(waves, w, straylight), 0.0)), static_cast<float>(w.covered)};
    for (const Wave& wave : waves)
        for (const double v : {wave.um, wave.weight, wave.straylight}) table.push_back(static_cast<float>(v));
    return table;
}

double sum_of_waves(const CurveInput& in, WaveOptics w, double deg, double straylight) {
    double sum = 0;
    w.direct = static_cast<double>(in.table[1]);
    for (std::size_t at = 3; at < in.table.size(); at += 3) {
        const auto um = static_cast<double>(in.table[at]), weight = static_cast<double>(in.table[at + 1]), share = static_cast<double>(in.table[at + 2]);
        const double sine = std::sin(deg * degree);
        sum += weight * (glare_psf::direct_light(w, um, sine) + glare_psf::scattered_light(w, um, sine, deg) + share * straylight);
    }
    return sum;
}

// --- closed_form ---

WaveOptics closed_form_optics(const CurveInput& in) {
    const auto p = in.as<ClosedFormParams>();
    WaveOptics w = optics_of(p, in.own[0]);
    w.fibres = static_cast<double>(p.lenticular_halo) * closed_form::lenticular_share(in.own[0]);
    return w;
}

// As the model's: particles and a pupil of 4 mm take their light from the straylight beyond a degree, and its colour has the luminance 1.
std::vector<float> closed_form_table(const CurveInput& in) {
    const auto p = in.as<ClosedFormParams>();
    const auto colour = [&](double um) {
        return glm::mix(1.0, closed_form::straylight_colour(um * 1000, static_cast<double>(p.pigment)), static_cast<double>(p.straylight_colour));
    };
    const WaveOptics mean = optics_of(p, 4);
    double luminance = 0, others = 0;
    for (const Wave& wave : waves_of(0)) {
        luminance += wave.weight * colour(wave.um);
        others += wave.weight * scattered(1, 180, [&](double deg) { return glare_psf::scattered_light(mean, wave.um, std::sin(std::min(deg, 90.0) * degree), deg); });
    }
    const double left = std::max(1 - others / scattered(1, 180, [&](double deg) { return straylight_at(p, deg); }), 0.0);
    std::vector<Wave> waves = waves_of(in.own[1]);
    for (Wave& wave : waves) wave.straylight = left * colour(wave.um) / luminance;
    return table_of(waves, closed_form_optics(in), scattered(1e-4, 90, [&](double deg) { return straylight_at(p, deg); }));
}
double closed_form_psf(const CurveInput& in, double deg) { return sum_of_waves(in, closed_form_optics(in), deg, straylight_at(in.as<ClosedFormParams>(), deg)); }

// --- luidolt_spectral ---

std::vector<float> luidolt_table(const CurveInput& in) { return table_of(waves_of(in.own[1]), optics_of(in.as<LuidoltSpectralParams>(), in.own[0]), 0); }
double luidolt_psf(const CurveInput& in, double deg) { return sum_of_waves(in, optics_of(in.as<LuidoltSpectralParams>(), in.own[0]), deg, 0); }

// --- cie135 ---

double cie135_total(const CurveInput& in, double deg) {
    const auto p = in.as<Cie135Params>();
    return cie135::total_psf(deg, static_cast<double>(p.age), static_cast<double>(p.pigment));
}
std::vector<float> cie135_table(const CurveInput& in) {
    return {static_cast<float>(scattered(1e-6, 90, [&](double deg) { return cie135_total(in, deg); }))};
}
double cie135_psf(const CurveInput& in, double deg) { return cie135_total(in, deg) / static_cast<double>(in.table[0]); }

}  // namespace

Curve mask_curve(const CurveKind& kind);

std::vector<Curve> glare_curves() {
    static const CurveKind kind{"glare.psf", "glare", "angle from the source", "degrees", 0, 90, "point spread, its azimuthal mean", "1/sr",
                                {{"pupil_mm", "mm", 1, 9, 4, "diameter of the pupil"},
                                 {"wavelength_nm", "nm", 380, 780, 0, "light of one wavelength; left out: photopic, of equal energy", true}}};
    static const std::vector<CurveAlias> pupil = {
        {"particle_diameter_um", {"particle_diameter_um"}}, {"particles_per_mm2", {"particles_per_mm2"}}, {"diffraction", {"diffraction"}}};
    static const std::vector<CurveAlias> person = {{"age", {"age"}}, {"pigment", {"pigment"}}};
    std::vector<CurveAlias> both = person;
    both.insert(both.end(), pupil.begin(), pupil.end());
    for (const char* name : {"straylight_factor", "lenticular_halo", "straylight_colour"}) both.push_back({name, {name}});
    using namespace curve_reference;
    // The references take the mean over rings by their encircled energy, which differs by some per cent beside the core.
    return {{&kind, "closed_form", glare_psf_closed_form_comp_spv, &each<closed_form_psf>, &closed_form_scatter, both, {}, &closed_form_table, 0.06},
            {&kind, "cie135", glare_psf_cie135_comp_spv, &each<cie135_psf>, &cie135_scatter, person, {"pupil_mm", "wavelength_nm"}, &cie135_table},
            {&kind, "luidolt_spectral", glare_psf_luidolt_spectral_comp_spv, &each<luidolt_psf>, &luidolt_spectral_scatter, pupil, {}, &luidolt_table, 0.06},
            mask_curve(kind)};
}

}  // namespace entoptic::perception
