#include "perception/glare/glare_spectrum.h"

#include "perception/glare/glare_math.glsl"

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

}  // namespace entoptic::perception
