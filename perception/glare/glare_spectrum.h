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
// For what is tabulated, more wavelengths cost nothing per frame, and with few the outer rings would stand apart.
constexpr int table_wavelengths = 96;

}  // namespace entoptic::perception
