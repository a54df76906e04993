// An ellipse in a picture. Coordinates are pixels, x right, y down, with pixel centres at whole numbers + 0.5 (the first pixel's centre is
// at 0.5, 0.5), so that they do not depend on the size of the pixels.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace entoptic::drivers {

struct Ellipse {
    double x = 0, y = 0;          // centre, px
    double major = 0, minor = 0;  // full lengths of the axes, px; major >= minor
    double angle = 0;             // of the major axis, radians from +x towards +y (down), 0 <= angle < pi

    double area() const { return 0.25 * M_PI * major * minor; }
    double perimeter() const;  // Ramanujan 1914, second formula: relative error below 1e-4 for any shape used here
    double axis_ratio() const { return major > 0 ? minor / major : 0; }
};

// Points of an ellipse, given the cosine and sine of their parameter (not the polar angle): many points, one sine of the ellipse's own.
class EllipsePoints {
public:
    explicit EllipsePoints(const Ellipse& ellipse)
        : centre_(ellipse.x, ellipse.y),
          cos_(std::cos(ellipse.angle)),
          sin_(std::sin(ellipse.angle)),
          a_(0.5 * ellipse.major),
          b_(0.5 * ellipse.minor) {}

    Eigen::Vector2d point(const Eigen::Vector2d& t, double radius = 1) const {
        return centre_ + turned(radius * a_ * t.x(), radius * b_ * t.y());
    }
    // Outward, of length 1.
    Eigen::Vector2d normal(const Eigen::Vector2d& t) const {
        const double u = b_ * t.x(), v = a_ * t.y();
        return turned(u, v) / std::sqrt(u * u + v * v);
    }
    // Along the axes.
    Eigen::Vector2d turned(double u, double v) const { return {cos_ * u - sin_ * v, sin_ * u + cos_ * v}; }
    double half_major() const { return a_; }
    double half_minor() const { return b_; }

private:
    Eigen::Vector2d centre_;
    double cos_, sin_, a_, b_;
};

// The same ellipse in a picture whose pixels are `factor` times smaller.
Ellipse scaled(const Ellipse& ellipse, double factor);

// Axes in order and angle in range, for any half lengths and angle.
Ellipse ellipse_of(double x, double y, double half_a, double half_b, double angle_a);

}  // namespace entoptic::drivers
