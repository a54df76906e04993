// The wavelengths over which glare models sum, in double.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace entoptic::perception {

struct GlareSpectrum {
    std::vector<double> nm;
    std::vector<glm::dvec3> weight;      // of each wavelength in linear BT.709 R, G, B; signed
    glm::dvec3 gain{0};                  // sum of the weights
};

// k midpoints of 400..700 nm, which waste fewer samples than end points do; equal-energy light, each channel sums to 1, so that a kernel
// of energy 1 at every wavelength is white.
GlareSpectrum midpoint_spectrum(int k);
// As midpoint_spectrum(), for light that the primary (channel + turn) mod 3 sends and a channel sees. The sum of a channel's weights is 1 for
// turn 0, else 0: a primary in the scene is that primary, only its scattered light has other colours.
GlareSpectrum emission_spectrum(int k, int turn);
// For what is tabulated, more wavelengths cost nothing per frame, and with few the outer rings would stand apart.
constexpr int table_wavelengths = 96;

}  // namespace entoptic::perception
