#include "drivers/pupil_labs/eye_optics.h"

#include <Eigen/Geometry>
#include <cmath>

namespace entoptic::drivers {

double EyeDimensions::entrance_magnification() const {
    const double depth = cornea_distance_mm + cornea_radius_mm - pupil_distance_mm;  // of the pupil behind the apex
    const double image = 1 / (refractive_index / depth - (refractive_index - 1) / cornea_radius_mm);
    return refractive_index * image / depth;
}

// In the plane of the camera, the point and the sphere's centre the exit point is one angle: the root of Snell's law, by Newton's method from
// the straight line.
std::optional<Eigen::Vector3d> exit_point(const EyeDimensions& eye, const Eigen::Vector3d& cornea_centre, const Eigen::Vector3d& inside) {
    const Eigen::Vector3d to_camera = -cornea_centre;
    const double distance = to_camera.norm();
    if (!(distance > 1.01 * eye.cornea_radius_mm)) return std::nullopt;
    const Eigen::Vector3d along = to_camera / distance, offset = inside - cornea_centre;
    const double u = offset.dot(along);
    const Eigen::Vector3d side = offset - u * along;
    const double v = side.norm(), r = eye.cornea_radius_mm;
    if (!(u * u + v * v < r * r)) return std::nullopt;
    if (v < 1e-9) return cornea_centre + r * along;
    // The exit point is r (cos a, sin a) in (along, side/v); the camera at (distance, 0), the inside point at (u, v). With the ray's parts before
    // and behind it: index * sine inside - sine outside = 0, sines with the sphere's normal.
    const double squares_in = r * r + u * u + v * v, squares_out = r * r + distance * distance;
    double a = v / r * (distance - r) / (distance - u), low = 0, high = 0.5 * M_PI, c = 1, s = 0;  // about the straight line
    for (int i = 0; i < 30; ++i) {
        c = std::cos(a);
        s = std::sin(a);
        const double in = s * u - c * v, in_slope = c * u + s * v, in_length = std::sqrt(squares_in - 2 * r * in_slope);
        const double out = -s * distance, out_slope = -c * distance, out_length = std::sqrt(squares_out + 2 * r * out_slope);
        const double value = eye.refractive_index * in / in_length - out / out_length;
        // Derivatives of x / length: the squares of the lengths change by -2 r times -in and by 2 r times -out.
        const double slope = eye.refractive_index * (in_slope - in * r * in / (in_length * in_length)) / in_length -
                             (out_slope + out * r * out / (out_length * out_length)) / out_length;
        (value < 0 ? low : high) = a;
        double next = a - value / slope;
        if (!(next >= low && next <= high)) next = 0.5 * (low + high);
        const double step = std::abs(next - a);
        a = next;
        if (step < 1e-9) break;
    }
    if (!(c * distance > r)) return std::nullopt;  // the camera is below that point's horizon
    return cornea_centre + r * (std::cos(a) * along + std::sin(a) * side / v);
}

bool pupil_outline(const PinholeCamera& camera, const EyeDimensions& eye, const EyePose& pose, std::span<Eigen::Vector2d> points) {
    const Eigen::Vector3d centre = pose.rotation_centre + eye.pupil_distance_mm * pose.optical_axis;
    const Eigen::Vector3d cornea = pose.rotation_centre + eye.cornea_distance_mm * pose.optical_axis;
    const Eigen::Vector3d across = pose.optical_axis.unitOrthogonal(), up = pose.optical_axis.cross(across);
    const double turn = 2 * M_PI / static_cast<double>(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double t = turn * static_cast<double>(i);
        const auto exit = exit_point(eye, cornea, centre + pose.pupil_radius_mm * (std::cos(t) * across + std::sin(t) * up));
        if (!exit || !(exit->z() > 1)) return false;
        points[i] = camera.project(*exit);
    }
    return true;
}

}  // namespace entoptic::drivers
