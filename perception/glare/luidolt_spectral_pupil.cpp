#include "perception/glare/luidolt_spectral_pupil.h"

#include "base/noise.h"
#include "perception/glare/glare_engine.h"
#include "perception/glare/glare_math.glsl"
#include "perception/glare/glare_spectrum.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

constexpr double pi = 3.14159265358979323846;

bool as_printed(const LuidoltSpectralParams& params) { return params.as_printed > 0.5f; }

int wavelength_count(const LuidoltSpectralParams& params) { return std::clamp(static_cast<int>(std::lround(params.wavelengths)), 3, 32); }

// Eq. 10 as printed has its end points at 380 and 770 nm, where the eye sees nothing: k + 1 samples, two of them wasted (trap L9).
// Eq. 9 as printed lacks (lambda0/lambda)^2, so that long waves get too much energy (trap L7); only the mean of the channels sums to 1, and
// the picture takes on the kernel's colour.
GlareSpectrum printed_spectrum(int k) {
    GlareSpectrum spectrum;
    for (int i = 0; i <= k; ++i) {
        const double nm = 380 + (770.0 - 380.0) * i / k;
        spectrum.nm.push_back(nm);
        spectrum.weight.push_back(glare::rgb_of_xyz(glare::wyman_xyz(nm)) * std::pow(nm / (1000 * glare_lambda0_um), 2));
        spectrum.gain += spectrum.weight.back();
    }
    const double norm = (spectrum.gain.x + spectrum.gain.y + spectrum.gain.z) / 3;
    for (glm::dvec3& weight : spectrum.weight) weight /= norm;
    spectrum.gain /= norm;
    return spectrum;
}

GlareSpectrum table_spectrum(const LuidoltSpectralParams& params) {
    return as_printed(params) ? printed_spectrum(wavelength_count(params)) : midpoint_spectrum(table_wavelengths);
}

}  // namespace

SpectralTable make_spectrum(const LuidoltSpectralParams& params) {
    const int k = wavelength_count(params);
    const GlareSpectrum few = as_printed(params) ? printed_spectrum(k) : midpoint_spectrum(k), many = table_spectrum(params);
    SpectralTable table{};
    table.count = static_cast<uint>(few.nm.size());
    for (std::size_t i = 0; i < few.nm.size(); ++i) {
        table.lambda_um[i] = static_cast<float>(few.nm[i] / 1000);
        table.weight[i] = few.weight[i];
    }
    glm::dvec3 mean_lambda{0};
    for (std::size_t i = 0; i < many.nm.size(); ++i) mean_lambda += many.weight[i] * (many.nm[i] / 1000);
    table.mean_lambda_um = mean_lambda;
    table.gain = few.gain;
    return table;
}

std::vector<vec3> make_halo_table(const LuidoltSpectralParams& params) {
    const GlareSpectrum spectrum = table_spectrum(params);
    std::vector<vec3> table(halo_table_size);
    for (uint i = 0; i < halo_table_size; ++i) {
        const double sine = static_cast<double>(i) / (halo_table_size - 1);
        glm::dvec3 sum{0};
        for (std::size_t k = 0; k < spectrum.nm.size(); ++k)
            sum += spectrum.weight[k] * glare::disc_scatter(static_cast<double>(params.particle_diameter_um), spectrum.nm[k] / 1000, sine);
        table[i] = sum;
    }
    return table;
}

double covered_share(const LuidoltSpectralParams& params, double pupil_mm) {
    const double disc_mm2 = pi / 4 * std::pow(static_cast<double>(params.particle_diameter_um) * 1e-3, 2);
    // As printed, 1000 particles are thrown into whatever pupil there is.
    const double density = as_printed(params) ? 1000 / (pi / 4 * pupil_mm * pupil_mm) : static_cast<double>(params.particles_per_mm2);
    return -std::expm1(-density * disc_mm2);
}

double scattered_share(const LuidoltSpectralParams& params, const SpectralTable& spectrum, double pupil_mm, double pixel_rad) {
    // Aperture tail beyond half a pixel: integral of lambda / (pi^3 D theta^3) 2 pi theta dtheta = 2 lambda / (pi^2 D theta).
    const double lambda_um = static_cast<double>(std::max({spectrum.mean_lambda_um.x, spectrum.mean_lambda_um.y, spectrum.mean_lambda_um.z}));
    const double tail = 2 * lambda_um * 1e-3 / (pi * pi * pupil_mm * 0.5 * pixel_rad) * static_cast<double>(params.angle_scale);
    const double f = covered_share(params, pupil_mm);
    return f * static_cast<double>(std::max({1.0f, spectrum.gain.x, spectrum.gain.y, spectrum.gain.z})) +
           (1 - f) * static_cast<double>(params.diffraction) * std::min(tail, 1.0);
}

double safe_strength(const LuidoltSpectralParams& params, const SpectralTable& spectrum, double pupil_mm, double pixel_rad) {
    const double scattered = scattered_share(params, spectrum, pupil_mm, pixel_rad);
    return std::min(static_cast<double>(params.strength), scattered > 0 ? 0.9 / scattered : static_cast<double>(params.strength));
}

namespace {

// Above this density more particles do not change the statistics of the speckle, only the time to place them.
constexpr double densest_texture_per_mm2 = 2000;

std::vector<glm::dvec2> scatter_particles(const LuidoltSpectralParams& params, std::uint64_t seed) {
    const double radius = largest_pupil_mm / 2 + 1e-3 * glare_patch_um;
    const double density = std::min(static_cast<double>(params.particles_per_mm2), densest_texture_per_mm2);
    const auto count = static_cast<std::uint64_t>(std::llround(density * pi * radius * radius));
    std::vector<glm::dvec2> at;
    at.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) {
        const double r = radius * std::sqrt(uniform01(seed, 2 * i)), phi = 2 * pi * uniform01(seed, 2 * i + 1);
        at.push_back({r * std::cos(phi), r * std::sin(phi)});
    }
    return at;
}

double hann(glm::dvec2 at) {
    return (0.5 - 0.5 * std::cos(2 * pi / glare_n * at.x)) * (0.5 - 0.5 * std::cos(2 * pi / glare_n * at.y));
}

void add_patch(const std::vector<glm::dvec2>& particles, glm::dvec2 centre_mm, ParticleField& field) {
    std::vector<std::vector<vec2>> cells(cells_per_side * cells_per_side);
    std::vector<vec2> once;
    double windows = 0, squares = 0;
    for (const glm::dvec2& p : particles) {
        const glm::dvec2 at = ((p - centre_mm) * 1e3 / glare_patch_um + 0.5) * static_cast<double>(glare_n);
        if (at.x < 2 || at.y < 2 || at.x > glare_n - 3.0 || at.y > glare_n - 3.0) continue;
        once.push_back(at);
        windows += hann(at);
        squares += hann(at) * hann(at);
        for (auto y = static_cast<uint>(at.y - 2) / cell_samples; y <= static_cast<uint>(at.y + 2) / cell_samples; ++y)
            for (auto x = static_cast<uint>(at.x - 2) / cell_samples; x <= static_cast<uint>(at.x + 2) / cell_samples; ++x)
                cells[y * cells_per_side + x].push_back(at);
    }
    for (const auto& cell : cells) {
        field.particles.insert(field.particles.end(), cell.begin(), cell.end());
        field.cell_offsets.push_back(static_cast<uint>(field.particles.size()));
    }
    // The Hann window's mean is 1/2 each way.
    field.mean.push_back(glm::dvec2(windows / (0.25 * glare_n * glare_n), squares));
    field.patch_particles.push_back(std::move(once));
}

}  // namespace

ParticleField make_particles(const LuidoltSpectralParams& params, std::uint64_t seed) {
    ParticleField field;
    field.cell_offsets.push_back(0);
    const bool any = params.particles_per_mm2 > 0 && params.patches >= 2;
    field.pairs = any ? static_cast<uint>(std::lround(params.patches)) / 2 : 0;
    const std::vector<glm::dvec2> particles = any ? scatter_particles(params, seed) : std::vector<glm::dvec2>{};
    // Radii grow evenly, so that a small pupil still has many patches; directions by the golden angle.
    for (uint pair = 0; pair < field.pairs; ++pair) {
        const double r = largest_pupil_mm / 2 * (pair + 0.5) / field.pairs, phi = pair * pi * (3 - std::sqrt(5.0));
        field.radius_mm.push_back(static_cast<float>(r));
        for (const double side : {1.0, -1.0}) add_patch(particles, {side * r * std::cos(phi), side * r * std::sin(phi)}, field);
    }
    return field;
}

}  // namespace entoptic::perception
