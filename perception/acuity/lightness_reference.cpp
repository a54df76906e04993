#include "perception/acuity/lightness_reference.h"

#include "shaders/geometry.glsl"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

double lightness_of(double y) {
    const double delta = 6.0 / 29, t = y / 100;
    return 116 * (t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29) - 16;
}
double luminance_of(double lightness) {
    const double delta = 6.0 / 29, f = (lightness + 16) / 116;
    return 100 * (f > delta ? std::pow(f, 3) : 3 * delta * delta * (f - 4.0 / 29));
}

double pixels_per_degree(const EyeGeometry& g, double x, double y) {
    const auto direction = [&](double dx, double dy) { return glm::normalize(geometry::geometry_direction(g, {x + dx, y + dy})); };
    const glm::dvec3 across = direction(0.5, 0) - direction(-0.5, 0), down = direction(0, 0.5) - direction(0, -0.5);
    const double a = glm::dot(across, across), b = glm::dot(down, down), c = glm::dot(across, down);
    return 3.14159265358979323846 / 180 / std::pow(a * b - c * c, 0.25);  // the square root of the parallelogram's area, Gram's determinant
}

// Weight of the pixel k away: the Gaussian's integral over it.
double weight(double sigma, int k) {
    const double root2 = std::sqrt(2.0);
    return 0.5 * (std::erf((k + 0.5) / (sigma * root2)) - std::erf((k - 0.5) / (sigma * root2)));
}

bool visible(const ReferenceFrame& frame, int x, int y) { return geometry::geometry_visible(frame.geometry, {x + 0.5, y + 0.5}); }
double luminance(const ImageD& image, int x, int y) {
    return 0.2126 * image.at(x, y, 0) + 0.7152 * image.at(x, y, 1) + 0.0722 * image.at(x, y, 2);
}
double blurred(const ImageD& plane, int x0, int y0, double sigma) {
    const int radius = static_cast<int>(std::ceil(6 * sigma));
    double sum = 0, weights = 0;
    for (int y = std::max(y0 - radius, 0); y <= std::min(y0 + radius, plane.height - 1); ++y)
        for (int x = std::max(x0 - radius, 0); x <= std::min(x0 + radius, plane.width - 1); ++x) {
            const double l = plane.at(x, y, 0);
            if (l < 0) continue;
            const double w = weight(sigma, x - x0) * weight(sigma, y - y0);
            sum += w * l;
            weights += w;
        }
    return sum / weights;
}
void recolour(double* pixel, double y, double y_new) {
    const double coloured = std::min(y_new, 16 * y);
    for (int c = 0; c < 3; ++c) pixel[c] = (y > 0 ? pixel[c] / y * coloured : 0.0) + (y_new - coloured);
}

}  // namespace

void blur_lightness(ReferenceFrame& frame, const LightnessSigma& sigma_px) {
    const int width = frame.image.width, height = frame.image.height;
    ImageD plane(width, height, 1);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) plane.at(x, y, 0) = visible(frame, x, y) ? lightness_of(luminance(frame.image, x, y)) : -1;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double l = plane.at(x, y, 0);
            if (l < 0) continue;
            const double before = luminance(frame.image, x, y);
            const double sigma = sigma_px(l, before, pixels_per_degree(frame.geometry, x + 0.5, y + 0.5));
            if (sigma > 0) recolour(&frame.image.at(x, y, 0), before, luminance_of(blurred(plane, x, y, sigma)));
        }
}

}  // namespace entoptic::perception
