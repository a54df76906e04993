// Fraunhofer diffraction by an aperture: the light that reaches each direction is the squared modulus of the aperture's Fourier transform
// (Kakimoto 2004, eq. 5). Computed on the CPU when the aperture changes, never per frame.
#pragma once

#include "perception/glare/fraunhofer_mask_aperture.h"
#include "shaders/shared_types.h"

#include <complex>
#include <span>
#include <vector>

namespace entoptic::perception {

// In-place transform of rows x rows values, a power of two a side; sign -1 in the exponent. Rows that are all zero cost nothing.
void fourier_transform(std::vector<std::complex<double>>& plane, int n);

// How n samples of a plane see the light of one wavelength (facts 3.3a).
struct PsfSampling {
    double aperture_pitch_um = 0, pitch_deg = 0, half_extent_deg = 0;
};
PsfSampling psf_sampling(int n, double plane_mm, double wavelength_nm);

// Light in frequency space, 1/mm; frequency is sin(angle) / wavelength.
struct Psf {
    int n = 0;
    double bin_per_mm = 0;        // between samples: 1 / plane
    ImageD density;               // of energy, per (1/mm)^2, energy of all 1; frequency 0 at (n/2, n/2), rows downwards
    double used_per_mm() const { return 0.25 * n * bin_per_mm; }     // the inner half of the extent (facts 3.3, trap L12)
};
// An aperture that passes no light gives a density of 0.
Psf make_psf(const ApertureRaster& aperture);

// Wavelengths and what each gives to R, G and B; each column sums to 1.
struct DiffractedSpectrum {
    std::vector<double> lambda_um;
    std::vector<glm::dvec3> weight;
};
DiffractedSpectrum diffracted_spectrum(const FraunhoferMaskParams& params);

// The PSF of all wavelengths over sine (log) and azimuth (linear), see fraunhofer_mask_math.glsl: level 0, then its means over 2 x 2, 4 x 4 …
std::vector<vec3> make_mask_table(const Psf& psf, const DiffractedSpectrum& spectrum);
// Share of the light that the table sends farther than a sine, of the channel that sends most.
double diffracted_beyond(const std::vector<vec3>& table, double sine);

}  // namespace entoptic::perception
