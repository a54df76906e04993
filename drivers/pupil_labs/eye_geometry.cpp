#include "drivers/pupil_labs/eye_geometry.h"

#include <Eigen/Dense>
#include <cmath>

namespace entoptic::drivers {

namespace {

// The conic x^T M x = 0 of an ellipse in homogeneous coordinates relative to the principal point, in units of the focal length.
Eigen::Matrix3d conic_of(const PinholeCamera& camera, const Ellipse& e) {
    const double c = std::cos(e.angle), s = std::sin(e.angle), f = camera.focal_px;
    Eigen::Matrix2d axes;
    axes << c, -s, s, c;
    const Eigen::Vector2d inverse(4 * f * f / (e.major * e.major), 4 * f * f / (e.minor * e.minor));
    const Eigen::Matrix2d shape = axes * inverse.asDiagonal() * axes.transpose();
    const Eigen::Vector2d centre((e.x - camera.centre_x) / f, (e.y - camera.centre_y) / f);
    Eigen::Matrix3d conic;
    conic.topLeftCorner<2, 2>() = shape;
    conic.topRightCorner<2, 1>() = -shape * centre;
    conic.bottomLeftCorner<1, 2>() = conic.topRightCorner<2, 1>().transpose();
    conic(2, 2) = centre.dot(shape * centre) - 1;
    return conic;
}

}  // namespace

std::optional<Ellipse> projected(const PinholeCamera& camera, const Circle3& circle) {
    const Eigen::Vector3d &c = circle.centre, &n = circle.normal;
    if (!(c.z() > circle.radius)) return std::nullopt;
    const double cn = c.dot(n);
    const Eigen::Matrix3d q = cn * cn * Eigen::Matrix3d::Identity() - cn * (c * n.transpose() + n * c.transpose()) +
                              (c.squaredNorm() - circle.radius * circle.radius) * n * n.transpose();
    const Eigen::Matrix2d shape = q.topLeftCorner<2, 2>();
    if (!(shape.determinant() > 0)) return std::nullopt;
    const Eigen::Vector2d centre = -shape.inverse() * q.topRightCorner<2, 1>();
    const double level = -(q(2, 2) + q.topRightCorner<2, 1>().dot(centre));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(shape / level);
    if (!(solver.eigenvalues()[0] > 0)) return std::nullopt;
    const Eigen::Vector2d half = camera.focal_px * solver.eigenvalues().cwiseSqrt().cwiseInverse();
    const Eigen::Vector2d along = solver.eigenvectors().col(0);  // the smaller eigenvalue: the longer axis
    return ellipse_of(camera.focal_px * centre.x() + camera.centre_x, camera.focal_px * centre.y() + camera.centre_y, half[0], half[1],
                      std::atan2(along.y(), along.x()));
}

std::optional<std::array<Circle3, 2>> unprojected(const PinholeCamera& camera, const Ellipse& ellipse, double radius) {
    if (!(ellipse.minor > 0 && ellipse.major >= ellipse.minor)) return std::nullopt;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(conic_of(camera, ellipse));
    Eigen::Vector3d values = solver.eigenvalues();  // rising: one negative, two positive
    if (!(values[0] < 0 && values[1] > 0)) return std::nullopt;
    const double l1 = values[2], l2 = values[1], l3 = values[0];
    const Eigen::Vector3d e1 = solver.eigenvectors().col(2);
    Eigen::Vector3d e3 = solver.eigenvectors().col(0);
    if (e3.z() < 0) e3 = -e3;
    const double g = std::sqrt((l1 - l2) / (l1 - l3)), h = std::sqrt((l2 - l3) / (l1 - l3)), scale = radius / std::sqrt(-l1 * l3);
    std::array<Circle3, 2> circles;
    for (std::size_t i = 0; i < 2; ++i) {
        const double s = i == 0 ? 1 : -1;
        Eigen::Vector3d normal = s * g * e1 - h * e3, centre = scale * (s * l3 * g * e1 - l1 * h * e3);
        if (centre.z() < 0) centre = -centre;
        if (normal.dot(centre) > 0) normal = -normal;
        circles[i] = {centre, normal, radius};
    }
    return circles;
}

}  // namespace entoptic::drivers
