#include "app/bench/bench_scene.h"

#include "app/simulation/scene_input.h"

#include <algorithm>
#include <cmath>

namespace entoptic::app {
namespace {

struct Colour {
    double r, g, b;
    Colour operator*(double k) const { return {r * k, g * k, b * k}; }
};

Colour room(double u, double v) {
    // A night room that has to be brightened: luminance falls over two decades and more from left to right; stripes from coarse to fine, warm
    // above, cool below.
    const double level = 0.1 * std::pow(10.0, -2.5 * u);
    const double stripes = 0.55 + 0.45 * std::sin(60 * u * (1 + 3 * v));
    const Colour tint = v < 0.5 ? Colour{1.1, 1.0, 0.8} : Colour{0.8, 1.0, 1.3};
    return tint * (level * (0.1 + 0.9 * stripes));
}

}  // namespace

ImageF bench_scene(int width, int height) {
    ImageF image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double u = (x + 0.5) / width, v = (y + 0.5) / height, aspect = double(height) / width;
            Colour c = room(u, v);
            // Together less than a thousandth of the pixels, so that the tone map does not take them for the scene.
            if (std::hypot(u - 0.25, (v - 0.3) * aspect) < 0.0125) c = {150, 110, 80};
            if (std::hypot(u - 0.75, (v - 0.7) * aspect) < std::max(0.003, 0.71 / width)) c = {500, 500, 500};
            image.at(x, y, 0) = static_cast<float>(c.r);
            image.at(x, y, 1) = static_cast<float>(c.g);
            image.at(x, y, 2) = static_cast<float>(c.b);
        }
    return image;
}

ImageF bench_scene_before(int width, int height) {
    const ImageF scene = bench_scene(width, height);
    ImageF before(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) before.at(x, y, c) = 0.1f * scene.at(width - 1 - x, y, c);
    return before;
}

ImageF bench_depth(int width, int height) {
    ImageF depth(width, height, 1);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float t = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
            depth.at(x, y, 0) = 1 / (t / 0.5f + (1 - t) / 20);
        }
    return depth;
}

EyeGeometry bench_geometry(int width, int height) { return *scene_geometry(Projection::rectilinear, 104.0, width, height); }

EyeGeometry headset_patch(int width, int height) {
    constexpr double pixels_a_radian = 13.85 * 180 / 3.14159265358979323846;
    const double fov_deg = 2 * std::atan(0.5 * width / pixels_a_radian) * 180 / 3.14159265358979323846;
    return *scene_geometry(Projection::rectilinear, fov_deg, width, height);
}

}  // namespace entoptic::app
