#include "drivers/pupil_labs/ellipse.h"

#include <utility>

namespace entoptic::drivers {

double Ellipse::perimeter() const {
    const double a = 0.5 * major, b = 0.5 * minor;
    if (!(a + b > 0)) return 0;
    const double h = (a - b) * (a - b) / ((a + b) * (a + b));
    return M_PI * (a + b) * (1 + 3 * h / (10 + std::sqrt(4 - 3 * h)));
}

Ellipse scaled(const Ellipse& ellipse, double factor) {
    return {ellipse.x * factor, ellipse.y * factor, ellipse.major * factor, ellipse.minor * factor, ellipse.angle};
}

Ellipse ellipse_of(double x, double y, double half_a, double half_b, double angle_a) {
    half_a = std::abs(half_a);
    half_b = std::abs(half_b);
    if (half_b > half_a) {
        std::swap(half_a, half_b);
        angle_a += 0.5 * M_PI;
    }
    double angle = std::fmod(angle_a, M_PI);
    if (angle < 0) angle += M_PI;
    if (angle >= M_PI) angle = 0;
    return {x, y, 2 * half_a, 2 * half_b, angle};
}

}  // namespace entoptic::drivers
