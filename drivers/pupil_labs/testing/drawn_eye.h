// For tests: pictures of an eye whose pupil is known. Not photographs: flat areas with soft edges, noise, reflections and lashes.
#pragma once

#include "base/image.h"
#include "drivers/pupil_labs/ellipse.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace entoptic::drivers::testing {

struct DrawnEye {
    int width = 192, height = 192;
    Ellipse pupil;
    double iris_radius = 40;                                       // px, around the pupil's centre
    double pupil_level = 60, iris_level = 110, white_level = 170;  // grey levels
    double noise = 2;                                              // standard deviation, grey levels
    double blur = 0.8;                                             // px, half width of the edges' ramps
    std::vector<Eigen::Vector2d> reflections;                      // px; bright discs of 3 px radius
    double lid_y = -1;                                             // everything above this row is lid
    int lashes = 0;                                                // dark lines hanging down from lid_y
    std::uint64_t seed = 1;
};

// Signed distance to the ellipse, px, negative inside; exact on the outline, first order near it.
inline double distance_to(const Ellipse& e, double x, double y) {
    const double c = std::cos(e.angle), s = std::sin(e.angle), u = (c * (x - e.x) + s * (y - e.y)) / (0.5 * e.major),
                 v = (-s * (x - e.x) + c * (y - e.y)) / (0.5 * e.minor);
    const double r = std::hypot(u, v);
    if (r < 1e-9) return -0.5 * e.minor;
    const double slope = std::hypot(u / (0.5 * e.major), v / (0.5 * e.minor)) / r;
    return (r - 1) / slope;
}

inline double ramp(double distance, double half_width) { return std::clamp(0.5 + 0.5 * distance / half_width, 0.0, 1.0); }

// Two uniform numbers to one of a normal distribution (Box and Muller 1958).
inline double normal_draw(std::uint64_t& state) {
    const auto next = [&state] {  // Marsaglia 2003, xorshift64
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        return (static_cast<double>(state >> 11) + 0.5) / 9007199254740992.0;
    };
    const double a = next(), b = next();
    return std::sqrt(-2 * std::log(a)) * std::cos(2 * M_PI * b);
}

inline Image8 draw(const DrawnEye& eye) {
    Image8 image(eye.width, eye.height, 1);
    std::uint64_t state = 0x9E3779B97F4A7C15ull * (eye.seed + 1);
    for (int row = 0; row < eye.height; ++row) {
        for (int column = 0; column < eye.width; ++column) {
            const double x = column + 0.5, y = row + 0.5;
            const double iris = ramp(std::hypot(x - eye.pupil.x, y - eye.pupil.y) - eye.iris_radius, 2 * eye.blur);
            double level = eye.iris_level + iris * (eye.white_level - eye.iris_level);
            level = eye.pupil_level + ramp(distance_to(eye.pupil, x, y), eye.blur) * (level - eye.pupil_level);
            for (const Eigen::Vector2d& at : eye.reflections)
                level = 250 + ramp(std::hypot(x - at.x(), y - at.y()) - 3, eye.blur) * (level - 250);
            if (eye.lid_y >= 0) level = eye.white_level + ramp(y - eye.lid_y, 1) * (level - eye.white_level);
            for (int lash = 0; lash < eye.lashes; ++lash) {
                const double at = (lash + 0.5) * eye.width / eye.lashes + 0.2 * (y - eye.lid_y);
                if (y > eye.lid_y - 4 && y < eye.lid_y + 14) level = 40 + ramp(std::abs(x - at) - 0.8, 0.8) * (level - 40);
            }
            image.at(column, row, 0) = static_cast<std::uint8_t>(std::clamp(level + eye.noise * normal_draw(state) + 0.5, 0.0, 255.0));
        }
    }
    return image;
}

}  // namespace entoptic::drivers::testing
