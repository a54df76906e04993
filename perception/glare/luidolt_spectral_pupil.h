// What the kernel of luidolt_spectral is made of, in double on the CPU: the spectrum, the halo of one particle, where the particles are.
// Computed when parameters change, never per frame.
#pragma once

#include "perception/glare/luidolt_spectral_gpu.h"
#include "perception/glare/luidolt_spectral_params.h"

#include <cstdint>
#include <vector>

namespace entoptic::perception {

// 575 nm, the wavelength of Luidolt 2020 section 4.2.2.
constexpr double glare_lambda0_um = 0.575;
// Width of a patch of the pupil: its transform has bins of 0.0722 degrees at 575 nm, one pixel of a Vive Pro (facts 3.4.4).
constexpr double glare_patch_um = 456.3;
SpectralTable make_spectrum(const LuidoltSpectralParams& params);

// Halo of the particles, over the whole spectrum, per sr and of energy 1, at sin(theta) = i / (halo_table_size - 1).
std::vector<vec3> make_halo_table(const LuidoltSpectralParams& params);

// Share f of the pupil that particles cover, which is the share of the light that passes which they scatter (facts 3.3:
// random discs, direct (1-f)^2, halo f (1-f), absorbed f).
double covered_share(const LuidoltSpectralParams& params, double pupil_mm);

// Upper bound of the share of light that leaves a pixel `pixel_rad` wide.
double scattered_share(const LuidoltSpectralParams& params, const SpectralTable& spectrum, double pupil_mm, double pixel_rad);

// Strength, lowered where the scattered share would pass 0.9 and the direct light turn negative.
double safe_strength(const LuidoltSpectralParams& params, const SpectralTable& spectrum, double pupil_mm, double pixel_rad);

// Particles of the eye, in patches at fixed places; pairs of patches stand opposite each other.
struct ParticleField {
    uint pairs = 0;
    std::vector<float> radius_mm;       // pair: distance of its patches from the pupil's centre
    std::vector<vec2> mean;             // patch: particles a sample under the window, sum of squared windows
    std::vector<uint> cell_offsets;     // patch, cell row, cell column, and one more at the end
    std::vector<vec2> particles;        // by cell; samples from the patch's corner. A particle is in every cell that its spline touches
    std::vector<std::vector<vec2>> patch_particles;   // the same, once each: for tests
};
ParticleField make_particles(const LuidoltSpectralParams& params, std::uint64_t seed);

}  // namespace entoptic::perception
