// Circles in space and their pictures. Camera coordinates: x right, y down, z into the picture, millimetres; pictures as in ellipse.h.
#pragma once

#include "drivers/pupil_labs/ellipse.h"

#include <Eigen/Core>
#include <array>
#include <optional>

namespace entoptic::drivers {

// Pinhole without distortion (the lenses of Pupil Labs' eye cameras are given so, facts/devices.md 3.2).
struct PinholeCamera {
    double focal_px = 280;
    double centre_x = 96, centre_y = 96;  // principal point, px

    Eigen::Vector2d project(const Eigen::Vector3d& p) const {
        return {focal_px * p.x() / p.z() + centre_x, focal_px * p.y() / p.z() + centre_y};
    }
    Eigen::Vector3d direction(double x, double y) const {
        return Eigen::Vector3d((x - centre_x) / focal_px, (y - centre_y) / focal_px, 1).normalized();
    }
};

struct Circle3 {
    Eigen::Vector3d centre{0, 0, 0}, normal{0, 0, -1};  // mm; unit, towards the camera
    double radius = 1;                                  // mm
};

// The ellipse that the camera sees of a circle wholly in front of it. None when it is not one (edge on, or partly behind).
std::optional<Ellipse> projected(const PinholeCamera& camera, const Circle3& circle);

// The two circles of this radius that the camera sees as this ellipse, both facing it (Safaee-Rad et al. 1992; the eigenvalues as in
// Swirski and Dodgson 2013). None for an ellipse without area.
std::optional<std::array<Circle3, 2>> unprojected(const PinholeCamera& camera, const Ellipse& ellipse, double radius);

}  // namespace entoptic::drivers
