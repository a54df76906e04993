// Fraunhofer diffraction by an aperture: the light that reaches each direction is the squared modulus of the aperture's Fourier transform
// (Kakimoto 2004, eq. 5). Computed on the CPU when the aperture changes, never per frame.
#pragma once

#include "perception/glare/fraunhofer_mask_aperture.h"
#include "shaders/shared_types.h"

#include <complex>
#include <span>
#include <vector>

namespace entoptic::perception {

// Transform of n x n real values, n a power of two, sign -1 in the exponent: frequencies (0 .. most, -most .. most), `most` < n / 2, in columns of
// one horizontal frequency: (u, v) at u (2 most + 1) + v + most. The others are conjugates. Rows that are all zero cost nothing.
std::vector<std::complex<double>> inner_transform(const ImageD& plane, int most);

// How n samples of a plane see the light of one wavelength (facts 3.3a).
struct PsfSampling {
    double aperture_pitch_um = 0, pitch_deg = 0, half_extent_deg = 0;
};
PsfSampling psf_sampling(int n, double plane_mm, double wavelength_nm);

// Light in frequency space: the inner half of the extent, farther out edges alias (facts 3.3, trap L12).
struct Psf {
    int most = 0;           // bins from the middle
    double bin_per_mm = 0;  // between samples: 1 / plane
    ImageD density;         // of energy, per (1/mm)^2, energy of all frequencies 1; frequency 0 at (most, most), rows downwards
    double at(int x, int y) const { return density.at(most + x, most + y, 0); }  // bins from the middle
    double used_per_mm() const { return most * bin_per_mm; }
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
