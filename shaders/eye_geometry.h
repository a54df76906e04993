// Geometry of an eye image: which direction each pixel shows. One struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_SHADERS_EYE_GEOMETRY_H
#define ENTOPTIC_SHADERS_EYE_GEOMETRY_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic {
#endif

// Kinds of eye image.
const uint geometry_lens = 0;         // the panel's own pixel grid, seen through the green lens: the density the optics give
const uint geometry_rectilinear = 1;  // a flat picture, as a camera makes it
const uint geometry_equirect = 2;     // longitude and latitude, -z in the middle

// Distortion of one colour; the formula is in interfaces/headset.h and in lens_gain() of shaders/geometry.glsl.
struct LensChannel {
    vec2 centre;         // ax, ay
    vec3 coefficients;   // k0, k1, k2
};

struct EyeGeometry {
    uint kind;
    uint width, height;     // pixels
    // Rectilinear: tangents of the field's edges, left and down negative.
    float tan_left, tan_right, tan_up, tan_down;
    // Lens:
    float aspect;           // panel width over height, physical
    vec3 r2_cutoff;         // of each colour: nothing is shown where its r² exceeds it
    vec2 focal, principal_point;   // of the undistorted view, normalised device coordinates per tangent
    LensChannel channels[3];       // red, green, blue
};

#ifdef __cplusplus
static_assert(sizeof(EyeGeometry) == 120, "scalar layout: the GLSL side must agree");
}  // namespace entoptic
#endif

#endif
