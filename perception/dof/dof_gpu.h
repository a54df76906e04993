// What the kernels of the slot `dof` share with their recorder. Scalar layout, one struct for C++ and GLSL.
#ifndef ENTOPTIC_PERCEPTION_DOF_DOF_GPU_H
#define ENTOPTIC_PERCEPTION_DOF_DOF_GPU_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

// Largest disc, and with it how far a tile's light can reach.
const float max_disc_radius_px = 32.0f;

// How colours differ in the blur.
const uint dof_colours_alike = 0;   // one radius
const uint dof_colours_lca = 1;     // a radius for each colour
const uint dof_colours_rows = 2;    // one radius, rows of the kernel coloured (Liu et al. 2021, section 3.3.2)

// One eye in one frame.
struct DofEye {
    vec3 gaze;          // unit, within the picture
    float pupil_mm;
};

// Both eyes focus as one.
struct DofFocus {
    float dioptre;      // where the eyes are focused; negative: nothing to focus on was ever known
    float target;       // where they are going; negative: not known in this frame
};

// A pixel as the gathering sees it.
struct DofPixel {
    float dioptre;      // unknown depth: that of the focus
    vec3 radius_px;     // of the disc in each colour; with dof_colours_rows (radius, side, 0), side as row_filter() has it
};

#ifdef __cplusplus
static_assert(sizeof(DofPixel) == 16, "scalar layout: the GLSL side must agree");
}  // namespace entoptic::perception
#endif

#endif
