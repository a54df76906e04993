// With none of the shaders' code: every pixel has its own weight and its own solid angle (by the spherical excess of its corners), and the
// median is found by sorting.
#include "perception/adaptation/reference_target.h"

#include "shaders/geometry.glsl"
#include "shaders/scene_statistics.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

using Direction = glm::dvec3;

// Solid angle of a spherical triangle (Van Oosterom and Strackee 1983).
double triangle_sr(const Direction& a, const Direction& b, const Direction& c) {
    const double volume = std::abs(glm::dot(a, glm::cross(b, c)));
    return 2 * std::atan2(volume, 1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
}

double pixel_sr(const EyeGeometry& g, double x, double y) {
    const auto corner = [&](double dx, double dy) { return geometry::geometry_direction(g, {x + dx, y + dy}); };
    const Direction a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
    return triangle_sr(a, b, c) + triangle_sr(a, c, d);
}

struct Pixel {
    double y, sr, angle_deg;
    std::size_t tile;
};

std::vector<Pixel> visible_pixels(const ReferenceFrame& frame) {
    std::vector<Pixel> pixels;
    const glm::dvec3 gaze = glm::normalize(glm::dvec3(frame.eye.gaze_direction));
    const std::size_t tiles_x = (static_cast<std::size_t>(frame.image.width) + tile_width - 1) / tile_width;
    for (int y = 0; y < frame.image.height; ++y)
        for (int x = 0; x < frame.image.width; ++x) {
            const glm::dvec2 centre(x + 0.5, y + 0.5);
            if (!geometry::geometry_visible(frame.geometry, centre)) continue;
            const Direction direction = geometry::geometry_direction(frame.geometry, centre);
            const double angle = std::atan2(glm::length(glm::cross(direction, gaze)), glm::dot(direction, gaze));
            const double luminance = 0.2126 * frame.image.at(x, y, 0) + 0.7152 * frame.image.at(x, y, 1) + 0.0722 * frame.image.at(x, y, 2);
            pixels.push_back({luminance, pixel_sr(frame.geometry, x, y), angle * 180 / 3.14159265358979323846,
                              static_cast<std::size_t>(y) / tile_height * tiles_x + static_cast<std::size_t>(x) / tile_width});
        }
    return pixels;
}

// Scales the light of tiles that are brighter than `ratio` times the median lit tile down to that.
void clip_outliers(std::vector<Pixel>& pixels, double ratio) {
    std::size_t tiles = 0;
    for (const Pixel& p : pixels) tiles = std::max(tiles, p.tile + 1);
    std::vector<double> light(tiles), sr(tiles), lit;
    for (const Pixel& p : pixels) light[p.tile] += p.y * p.sr, sr[p.tile] += p.sr;
    for (std::size_t t = 0; t < tiles; ++t) {
        light[t] = sr[t] > 0 ? light[t] / sr[t] : 0;
        if (light[t] > std::pow(10, -6 + 14.0 / 64)) lit.push_back(light[t]);
    }
    if (lit.empty()) return;
    std::sort(lit.begin(), lit.end());
    const double clip = ratio * lit[lit.size() / 2];
    for (Pixel& p : pixels)
        if (light[p.tile] > clip) p.y *= clip / light[p.tile];
}

double mean(const std::vector<Pixel>& pixels, double sigma_deg) {
    double sum = 0, weight = 0;
    for (const Pixel& p : pixels) {
        const double w = p.sr * std::exp(-0.5 * std::pow(p.angle_deg / sigma_deg, 2));
        sum += w * p.y;
        weight += w;
    }
    return weight > 0 ? sum / weight : 0;
}

// CIE 146:2002, general disability glare at age 30 and brown eyes, 1/sr. Light closer than a degree counts as at one.
double straylight_per_sr(double degrees) {
    const double t = std::clamp(degrees, 1.0, 100.0);
    return 10 / std::pow(t, 3) + 5 / std::pow(t, 2) * (1 + std::pow(30 / 62.5, 4));
}

double with_straylight(const std::vector<Pixel>& pixels, double near) {
    double lost = 0, veil = 0;
    for (const Pixel& p : pixels) {
        const double k = straylight_per_sr(p.angle_deg) * p.sr;
        lost += k;
        veil += k * p.y;
    }
    return near * (1 - lost) + veil;
}

}  // namespace

double reference_target(const ReferenceFrame& frame, const ReferenceWeights& weights) {
    std::vector<Pixel> pixels = visible_pixels(frame);
    clip_outliers(pixels, weights.clip_over_median);
    const double near = mean(pixels, weights.sigma_deg);
    if (weights.retinal) return with_straylight(pixels, near);
    return (1 - weights.wide_share) * near + weights.wide_share * mean(pixels, 1e6);
}

double reference_target_as_printed(const ReferenceFrame& frame, double sigma_deg) {
    double sum = 0;
    for (const Pixel& p : visible_pixels(frame)) sum += p.y * std::exp(-0.5 * std::pow(p.angle_deg / sigma_deg, 2));
    return sum / (static_cast<double>(frame.image.width) * frame.image.height);
}

std::optional<double> target_to_approach(ReferenceFrame& frame, double target, double floor) {
    target = std::max(target, floor);
    if (frame.snap || frame.adaptation_cd_m2 <= 0) {
        frame.adaptation_cd_m2 = target;
        return {};
    }
    if (frame.eye.eyelid_open < 0.5f || !(frame.dt_s > 0)) return {};
    return target;
}

}  // namespace entoptic::perception
