#include "perception/patch_noise_reference.h"

#include "base/noise.h"

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

}  // namespace

double patch_noise_reference(const ReferenceFrame& frame, const glm::dvec3& direction, double cell_deg, double ticks) {
    const glm::dvec3 gaze(frame.eye.gaze_direction);
    const auto longitude = [](const glm::dvec3& d) { return std::atan2(d.x, -d.z) * degrees; };
    const auto latitude = [](const glm::dvec3& d) { return std::asin(std::clamp(d.y, -1.0, 1.0)) * degrees; };
    const glm::dvec2 at(longitude(direction) - longitude(gaze), latitude(direction) - latitude(gaze));
    return patch_noise(static_cast<std::uint32_t>(mix64(frame.seed)), at / cell_deg, ticks);
}

}  // namespace entoptic::perception
