// The blur by local means in double, with none of the shaders' code: kernels by the C++ library's modified Bessel functions, a full 2-D sum
// at each pixel with the pixel's own width, local means by their definition.
#include "perception/acuity/local_blur.h"
#include "perception/patch_noise_reference.h"

#include "shaders/geometry.glsl"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

constexpr double degrees = 180 / 3.14159265358979323846;


// Mean of a picture around a pixel with the discrete Gaussian of this variance (px²) on both axes, over visible pixels.
glm::dvec3 blurred(const ImageD& image, const std::vector<char>& visible, int x0, int y0, double variance) {
    const int radius = static_cast<int>(std::ceil(5 * std::sqrt(variance) + 2));
    // I_n(t) of all n from n = 0 would overflow for large t only: t is at most 1296, and the ratio to I_0 is what counts.
    std::vector<double> weight(static_cast<std::size_t>(radius) + 1);
    for (std::size_t n = 0; n < weight.size(); ++n)
        weight[n] = variance < 500 ? std::cyl_bessel_i(static_cast<double>(n), variance) * std::exp(-variance)
                                   : std::exp(-0.5 * static_cast<double>(n * n) / variance) / std::sqrt(2 * 3.14159265358979323846 * variance);
    glm::dvec3 sum(0);
    double weights = 0;
    for (int y = std::max(y0 - radius, 0); y <= std::min(y0 + radius, image.height - 1); ++y)
        for (int x = std::max(x0 - radius, 0); x <= std::min(x0 + radius, image.width - 1); ++x) {
            if (!visible[static_cast<std::size_t>(y * image.width + x)]) continue;
            const double w = weight[static_cast<std::size_t>(std::abs(x - x0))] * weight[static_cast<std::size_t>(std::abs(y - y0))];
            sum += w * glm::dvec3(image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2));
            weights += w;
        }
    return sum / weights;
}

}  // namespace

void apply_local_blur(ReferenceFrame& frame, const LocalBlurLaw& law) {
    const ImageD picture = frame.image, mean = local_mean_reference(picture, frame.geometry, law.local_mean_deg);
    std::vector<char> visible;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) visible.push_back(geometry::geometry_visible(frame.geometry, {x + 0.5, y + 0.5}));
    const double black = static_cast<double>(frame.display.black_cd_m2), white = static_cast<double>(frame.display.white_cd_m2);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            if (!visible[static_cast<std::size_t>(y * picture.width + x)]) continue;
            const glm::dvec2 px(x + 0.5, y + 0.5);
            const glm::dvec3 direction = geometry::geometry_direction(frame.geometry, px);
            const double ppd = geometry::geometry_ppd(frame.geometry, px);
            double scene = std::max(mean.at(x, y, 0), 1e-6), panel = frame.displayed ? frame.displayed(scene) : std::min(scene, white);
            if (panel < black) scene *= black / panel, panel = black;
            const double eccentricity = degrees * std::acos(std::clamp(glm::dot(direction, glm::dvec3(frame.eye.gaze_direction)), -1.0, 1.0));
            const double noise = law.noisy ? patch_noise_reference(frame, direction, law.cell_deg, law.ticks) : 0;
            const double variance = std::min(law.added_variance(scene, panel, noise, eccentricity, ppd) * ppd * ppd / 3600, 1296.0);
            if (!(variance > 0)) continue;
            const glm::dvec3 c = blurred(picture, visible, x, y, variance);
            for (int k = 0; k < 3; ++k) frame.image.at(x, y, k) = c[k];
        }
}

}  // namespace entoptic::perception
