// What light passes on its way into the eye, as a picture of the pupil's plane: pupil or diaphragm, and the obstacles in front of it.
// Millimetres; x to the right, y up, from the pupil's centre, as the observer sees it.
#pragma once

#include "base/image.h"
#include "base/result.h"
#include "perception/glare/fraunhofer_mask_params.h"

#include <algorithm>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

namespace entoptic::perception {

// Picture of an obstacle. A value is the transmission factor of the light's amplitude, 0 opaque .. 1 clear: the linear grey value, times
// alpha where there is one. Past its border the picture goes on as its border is.
struct MaskPicture {
    ImageD transmission;    // 1 channel
};
// PNG (8-bit values over 255, not decoded by a display's curve) or OpenEXR (luminance, clamped to 0..1; its alpha is not read).
// Errors name the file and say what may be there.
Result<std::shared_ptr<const MaskPicture>> read_mask_picture(const std::string& path);

// One moment of the eye: what FraunhoferMaskParams leaves open.
struct ApertureState {
    double pupil_mm = 4;
    double eyelid_open = 1;       // 0 closed .. 1 open
    double obstacle_shift_mm = 0; // x by which the light's direction displaces the obstacles: d_o tan(phi), towards +x for light from the left
};

// The aperture on n x n samples of a square of `plane_mm`, rows from the top: the mean over each sample's own square, so that edges do not
// alias (facts 3.3, trap L12).
struct ApertureRaster {
    int n = 0;
    double plane_mm = 0;
    ImageD amplitude;             // mean transmission factor of amplitude
    double passed = 0;            // sum over the samples of the mean of amplitude squared: the light that passes
};
ApertureRaster raster_aperture(const FraunhoferMaskParams& params, const MaskPicture* picture, const ApertureState& state, int n, double plane_mm);

// Share of a unit square, centred `distance` inside a straight edge whose unit normal is (x, y), that lies inside.
double edge_coverage(double distance, double x, double y);

// Middle of the upper and the lower lid's edge, mm, and their curvature: y = middle -/+ x^2 / (2 lid_radius_mm).
struct LidEdges {
    double upper = 0, lower = 0;
};
LidEdges lid_edges(double open);
constexpr double lid_radius_mm = 22;      // 5 mm lower at the corners, 30 mm apart
// The lids lie on the eye, this far before its pupil; lashes, filters and pictures farther out.
constexpr double lid_distance_mm = 4;
inline double lid_shift_mm(const FraunhoferMaskParams& p, double shift_mm) {
    return shift_mm * std::min(1.0, lid_distance_mm / std::max(static_cast<double>(p.obstacle_mm), 1e-3));
}

// An eyelash before the pupil, a curve of the share s of its length: falls away from the lid, and with `curl` comes up again.
struct Lash {
    glm::dvec2 root, down, across;     // down: unit, away from the lid
    double length, curl;
    glm::dvec2 at(double s) const { return root + length * s * ((1 - curl * s) * down + 0.25 * curl * s * across); }
};
std::vector<Lash> grow_lashes(const FraunhoferMaskParams& params, double open, double shift_mm);

}  // namespace entoptic::perception
