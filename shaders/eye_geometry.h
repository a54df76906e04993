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
const uint geometry_foveated = 3;     // a disc about the gaze, which is -z: as many samples as the retina has (perception/foveation)

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
    // Foveated:
    float foveal_ppd;       // pixels per degree within 5.79 degrees of the gaze
    float edge_deg;         // eccentricity at which the disc ends
    uint fitted;            // 1: directions by Liu's fitted inverse, equation 3; 0: by the exact one
};

#ifdef __cplusplus
static_assert(sizeof(EyeGeometry) == 132, "scalar layout: the GLSL side must agree");
}  // namespace entoptic
#endif

#endif
