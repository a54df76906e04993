// How far away a composition layer is, as one eye sees it. One struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_COMPOSITOR_DEPTH_LAYER_H
#define ENTOPTIC_COMPOSITOR_DEPTH_LAYER_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::compositor {
#endif

const uint depth_known = 1;     // else the layer hides what is behind it without saying how far away it is
const uint depth_sampled = 2;   // from a depth image, else a plane at one distance
const uint depth_blends = 4;    // alpha of the colour says how much the layer covers

// Directions to texels as in compositor/layer_view.h, for the green lens: (a, b, w) = rows * (p.x, p.y, D). 1 over the distance along the
// layer's axis is dioptre_at_zero + dioptre_per_unit * value of the depth texel; the distance from the eye is that over the cosine.
struct DepthLayer {
    vec3 colour_from_lens[3], depth_from_lens[3];   // rows
    vec2 low, high;                                 // the colour's sub-image, texels: where the layer is seen
    vec2 depth_low, depth_high;                     // centres of the first and last depth texel
    float dioptre_at_zero, dioptre_per_unit;
    float least, most;                              // range of usable depth values
    uint flags;
};

#ifdef __cplusplus
static_assert(sizeof(DepthLayer) == 124, "scalar layout: the GLSL side must agree");
}  // namespace entoptic::compositor
#endif

#endif
