#include "perception/glare/glare_spectrum.h"

#include "perception/glare/glare_emission.h"
#include "perception/glare/glare_math.glsl"

#include <algorithm>

namespace entoptic::perception {

GlareSpectrum midpoint_spectrum(int k) {
    GlareSpectrum spectrum;
    for (int i = 0; i < k; ++i) {
        spectrum.nm.push_back(400 + 300 * (i + 0.5) / k);
        spectrum.weight.push_back(glare::rgb_of_xyz(glare::wyman_xyz(spectrum.nm.back())));
        spectrum.gain += spectrum.weight.back();
    }
    for (glm::dvec3& weight : spectrum.weight) weight /= spectrum.gain;
    spectrum.gain = glm::dvec3(1);
    return spectrum;
}

namespace {

// Power of the primaries at a wavelength.
glm::dvec3 emission(double nm) {
    const double place = (nm - emission_first_nm) / emission_step_nm;
    const auto i = std::min<std::size_t>(static_cast<std::size_t>(place), std::size(emission_basis) - 2);
    const auto &a = emission_basis[i], &b = emission_basis[i + 1];
    return glm::mix(glm::dvec3(a[0], a[1], a[2]), glm::dvec3(b[0], b[1], b[2]), place - static_cast<double>(i));
}

}  // namespace

GlareSpectrum emission_spectrum(int k, int turn) {
    GlareSpectrum spectrum = midpoint_spectrum(k);
    // What each primary is seen as, before and after it is made exact by mixing the primaries.
    glm::dmat3 seen(0.0);      // column: primary
    std::vector<glm::dvec3> colour;
    for (const double nm : spectrum.nm) {
        colour.push_back(glare::rgb_of_xyz(glare::wyman_xyz(nm)));
        seen += glm::outerProduct(colour.back(), emission(nm));
    }
    const glm::dmat3 exact = glm::inverse(seen);
    for (std::size_t i = 0; i < colour.size(); ++i) {
        const glm::dvec3 primaries = glm::transpose(exact) * emission(spectrum.nm[i]);
        for (int c = 0; c < 3; ++c) spectrum.weight[i][c] = colour[i][c] * primaries[(c + turn) % 3];
    }
    spectrum.gain = glm::dvec3(turn == 0 ? 1 : 0);
    return spectrum;
}

}  // namespace entoptic::perception
