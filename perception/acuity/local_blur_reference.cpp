// The blur by local means in double, with none of the shaders' code: kernels by the C++ library's modified Bessel functions, a full 2-D sum
// at each pixel with the pixel's own width, local means by their definition, noise by its definition as a weighted sum.
#include "perception/acuity/local_blur.h"

#include "base/noise.h"
#include "shaders/geometry.glsl"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

constexpr double degrees = 180 / 3.14159265358979323846;

// The finaliser of MurmurHash3 (Appleby, public domain).
std::uint32_t mixed(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x85ebca6bu;
    x ^= x >> 13;
    x *= 0xc2b2ae35u;
    return x ^ (x >> 16);
}

double lattice_normal(std::uint32_t seed, std::int64_t x, std::int64_t y, std::int64_t tick) {
    std::uint32_t h = mixed(seed ^ static_cast<std::uint32_t>(x));
    h = mixed((h + 0x9e3779b9u) ^ static_cast<std::uint32_t>(y));
    h = mixed((h + 0x9e3779b9u) ^ static_cast<std::uint32_t>(tick));
    const double u = ((h >> 8) + 0.5) / 16777216, v = (mixed(h ^ 0x68bc21ebu) >> 8) / 16777216.0;
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * 3.14159265358979323846 * v);
}

double patch_noise(std::uint32_t seed, glm::dvec2 at, double ticks) {
    const auto bump = [](double apart) { return apart >= 1 ? 0.0 : 1 - apart * apart * (3 - 2 * apart); };
    double sum = 0, squares = 0;
    for (int dx = 0; dx < 2; ++dx)
        for (int dy = 0; dy < 2; ++dy)
            for (int dt = 0; dt < 2; ++dt) {
                const double x = std::floor(at.x) + dx, y = std::floor(at.y) + dy, t = std::floor(ticks) + dt;
                const double weight = bump(std::abs(at.x - x)) * bump(std::abs(at.y - y)) * bump(std::abs(ticks - t));
                sum += weight * lattice_normal(seed, std::lround(x), std::lround(y), std::lround(t));
                squares += weight * weight;
            }
    return std::clamp(sum / std::sqrt(squares), -4.0, 4.0);
}

double noise_at(const ReferenceFrame& frame, const LocalBlurLaw& law, const glm::dvec3& direction) {
    const glm::dvec3 gaze(frame.eye.gaze_direction);
    const auto longitude = [](const glm::dvec3& d) { return std::atan2(d.x, -d.z) * degrees; };
    const auto latitude = [](const glm::dvec3& d) { return std::asin(std::clamp(d.y, -1.0, 1.0)) * degrees; };
    const glm::dvec2 at(longitude(direction) - longitude(gaze), latitude(direction) - latitude(gaze));
    return patch_noise(static_cast<std::uint32_t>(mix64(frame.seed)), at / law.cell_deg, law.ticks);
}

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
            const double noise = law.noisy ? noise_at(frame, law, direction) : 0;
            const double variance = std::min(law.added_variance(scene, panel, noise, eccentricity, ppd) * ppd * ppd / 3600, 1296.0);
            if (!(variance > 0)) continue;
            const glm::dvec3 c = blurred(picture, visible, x, y, variance);
            for (int k = 0; k < 3; ++k) frame.image.at(x, y, k) = c[k];
        }
}

}  // namespace entoptic::perception
