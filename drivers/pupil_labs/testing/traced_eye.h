// For tests: a picture of an eye by tracing every pixel's rays into it, through the cornea's sphere to the plane of pupil and iris. Another
// way than eye_optics.h, which looks for the way out: the two can be wrong only independently of each other.
#pragma once

#include "base/image.h"
#include "drivers/pupil_labs/eye_optics.h"
#include "drivers/pupil_labs/testing/drawn_eye.h"

#include <cmath>
#include <optional>

namespace entoptic::drivers::testing {

// Nearer crossing of the ray t * d (from the origin, unit d) with a sphere.
inline std::optional<double> sphere_crossing(const Eigen::Vector3d& d, const Eigen::Vector3d& centre, double radius) {
    const double along = d.dot(centre), miss = along * along - centre.squaredNorm() + radius * radius;
    if (miss <= 0) return std::nullopt;
    return along - std::sqrt(miss);
}

// Snell's law in vectors: unit d meets a surface of unit normal n (against d) into a medium of relative index `ratio`.
inline Eigen::Vector3d refracted(const Eigen::Vector3d& d, const Eigen::Vector3d& n, double ratio) {
    const double in = -d.dot(n), k = 1 / ratio, out = std::sqrt(1 - k * k * (1 - in * in));
    return k * d + (k * in - out) * n;
}

// Distance from the optical axis at which the ray meets the pupil's plane, mm; none when it does not go through the cornea.
inline std::optional<double> radius_at_pupil(const EyeDimensions& eye, const EyePose& pose, const Eigen::Vector3d& d) {
    const Eigen::Vector3d cornea = pose.rotation_centre + eye.cornea_distance_mm * pose.optical_axis;
    const auto t = sphere_crossing(d, cornea, eye.cornea_radius_mm);
    if (!t) return std::nullopt;
    const Eigen::Vector3d p = *t * d, n = (p - cornea) / eye.cornea_radius_mm;
    if ((p - pose.rotation_centre).dot(pose.optical_axis) < eye.pupil_distance_mm + 0.2) return std::nullopt;  // beside the limbus
    const Eigen::Vector3d in = refracted(d, n, eye.refractive_index);
    const double toward = in.dot(pose.optical_axis);
    if (!(toward < 0)) return std::nullopt;
    const Eigen::Vector3d centre = pose.rotation_centre + eye.pupil_distance_mm * pose.optical_axis;
    const Eigen::Vector3d at = p + (centre - p).dot(pose.optical_axis) / toward * in;
    return (at - centre).norm();
}

struct TracedEye {
    PinholeCamera camera;
    int width = 192, height = 192;
    EyeDimensions eye;
    EyePose pose;
    double iris_radius_mm = 5.9;
    double noise = 2;
    int samples = 2;  // a pixel, each way
    std::uint64_t seed = 1;
};

inline double level_along(const TracedEye& eye, const Eigen::Vector3d& d) {
    if (const auto radius = radius_at_pupil(eye.eye, eye.pose, d)) {
        if (*radius < eye.pose.pupil_radius_mm) return 55;
        if (*radius < eye.iris_radius_mm) return 105;
        return 165;
    }
    return sphere_crossing(d, eye.pose.rotation_centre, 12) ? 165 : 140;  // sclera, skin
}

inline Image8 traced(const TracedEye& eye) {
    Image8 image(eye.width, eye.height, 1);
    std::uint64_t state = 0x9E3779B97F4A7C15ull * (eye.seed + 1);
    for (int y = 0; y < eye.height; ++y) {
        for (int x = 0; x < eye.width; ++x) {
            double sum = 0;
            for (int v = 0; v < eye.samples; ++v)
                for (int u = 0; u < eye.samples; ++u)
                    sum += level_along(eye, eye.camera.direction(x + (u + 0.5) / eye.samples, y + (v + 0.5) / eye.samples));
            const double level = sum / (eye.samples * eye.samples) + eye.noise * normal_draw(state);
            image.at(x, y, 0) = static_cast<std::uint8_t>(std::clamp(level + 0.5, 0.0, 255.0));
        }
    }
    return image;
}

}  // namespace entoptic::drivers::testing
