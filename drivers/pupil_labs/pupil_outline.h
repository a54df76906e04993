// From a rough ellipse to the edge of the pupil: looks along the ellipse's normals for the step from dark to bright and moves the ellipse
// there by weighted least squares; lashes, lids and reflections are outliers. Then says how much of the outline is really there.
#pragma once

#include "drivers/pupil_labs/ellipse.h"
#include "drivers/pupil_labs/smooth_image.h"

#include <optional>

namespace entoptic::drivers {

// What the picture says for an ellipse being the outline of a dark disc.
struct OutlineQuality {
    double support = 0;   // share of the whole outline with an edge of the right sign close to the ellipse, 0..1
    double spread = 0;    // share of the 12 sectors of 30 degrees that have support, 0..1
    double contrast = 0;  // median step outside minus inside over the outline, grey levels
    double residual = 0;  // root mean square distance of the supporting edges to the ellipse, px
    double darkness = 0;  // share of the inside that is darker than the middle between both sides, 0..1
    double plateau = 0;  // share of directions in which it is still bright a third of the minor axis outside, 0..1 (a lash: both sides end)
};

struct Outline {
    Ellipse ellipse;
    OutlineQuality quality;
};

struct OutlineLimits {
    double min_diameter = 6, max_diameter = 90;  // px, major axis; choice of the caller's (anatomy and lens)
    double min_axis_ratio = 0.3;                 // an eye turned by 70 degrees away from the camera
};

// Refines `start`. None when the fit leaves the limits or the picture, or there are too few edges for an ellipse.
std::optional<Outline> refine_outline(const SmoothImage& image, const Ellipse& start, const OutlineLimits& limits);

// The share of 16 directions in which it steps from dark to bright across the ellipse by at least `step` grey levels: a quick test that tells
// a hopeless start from a possible one.
double quick_support(const SmoothImage& image, const Ellipse& ellipse, float step);

}  // namespace entoptic::drivers
