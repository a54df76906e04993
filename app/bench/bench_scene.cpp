#include "app/bench/bench_scene.h"

#include "app/simulation/scene_input.h"

#include <cmath>

namespace entoptic::app {
namespace {

struct Colour {
    double r, g, b;
    Colour operator*(double k) const { return {r * k, g * k, b * k}; }
};

Colour room(double u, double v) {
    // Luminance falls over two decades and more from left to right; stripes from coarse to fine, warm above, cool below.
    const double level = 3 * std::pow(10.0, -2.5 * u);
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
            if (std::hypot(u - 0.35, (v - 0.4) * aspect) < 0.02) c = {4e4, 3e4, 2e4};
            if (std::hypot(u - 0.7, (v - 0.6) * aspect) < 0.003) c = {1e6, 1e6, 1e6};
            image.at(x, y, 0) = static_cast<float>(c.r);
            image.at(x, y, 1) = static_cast<float>(c.g);
            image.at(x, y, 2) = static_cast<float>(c.b);
        }
    return image;
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

}  // namespace entoptic::app
