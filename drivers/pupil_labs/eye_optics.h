// The eye as seen from outside: a pupil behind a cornea that bends the light from its edge. Camera coordinates, millimetres.
#pragma once

#include "drivers/pupil_labs/eye_geometry.h"

#include <span>

namespace entoptic::drivers {

// Lengths along the optical axis from the centre of rotation. Gullstrand's schematic eye: the apex of the cornea is 13.5 mm before the
// centre of rotation, the pupil's plane 3.1 mm behind the apex (Le Grand's full theoretical eye: 3.04 mm; 10.39 mm is what Swirski and Dodgson's followers use).
struct EyeDimensions {
    double pupil_distance_mm = 10.39;  // centre of rotation to the pupil's plane
    double cornea_distance_mm = 5.7;   // ... to the centre of the cornea's sphere
    double cornea_radius_mm = 7.8;
    double refractive_index = 1.336;  // aqueous humour and cornea as one

    // How much wider the pupil looks from far in front than it is: paraxial image through the cornea's sphere.
    double entrance_magnification() const;
};

// One eye at one time.
struct EyePose {
    Eigen::Vector3d rotation_centre{0, 0, 35};
    Eigen::Vector3d optical_axis{0, 0, -1};  // unit, out of the eye
    double pupil_radius_mm = 2;              // of the pupil itself, not of its image
};

// Where on the cornea the light from `inside` (mm, camera coordinates) leaves it to reach the camera at the origin (Snell's law), as the
// point of the sphere. None when it does not.
std::optional<Eigen::Vector3d> exit_point(const EyeDimensions& eye, const Eigen::Vector3d& cornea_centre, const Eigen::Vector3d& inside);

// The pupil's edge in the picture: `count` points, evenly spread over the edge. False when some of them cannot be seen.
bool pupil_outline(const PinholeCamera& camera, const EyeDimensions& eye, const EyePose& pose, std::span<Eigen::Vector2d> points);

}  // namespace entoptic::drivers
