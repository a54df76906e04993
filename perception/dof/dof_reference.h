// For the references of the slot `dof`, in double and with none of the shaders' code: where the eye focuses, and light scattered pixel by
// pixel over discs whose overlap with each pixel is counted out.
#pragma once

#include "perception/model.h"

#include <functional>

namespace entoptic::perception {

// A pixel's disc.
struct ReferenceDisc {
    double dioptre = 0;
    double radius_px[3] = {0, 0, 0};
    int side = 0;   // for coloured rows: -1 beyond the focus, 1 in front of it
};

// One step of frame.focus_dioptre; false when nothing to focus on was ever known. A negative `fixed_dioptre` is none.
bool follow_focus(ReferenceFrame& frame, double fixed_dioptre, bool use_vergence, double tau_s);

// Blurs frame.image. `disc_of(dioptre, pixel_rad)` is asked for every visible pixel of known depth.
void scatter(ReferenceFrame& frame, const std::function<ReferenceDisc(double, double)>& disc_of, bool coloured_rows);

}  // namespace entoptic::perception
