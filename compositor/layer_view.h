// A composition layer as one eye sees it. One struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_COMPOSITOR_LAYER_VIEW_H
#define ENTOPTIC_COMPOSITOR_LAYER_VIEW_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::compositor {
#endif

const uint layer_slots = 16;

const uint layer_blends = 1;           // alpha of the texture counts, else the layer is opaque
const uint layer_unpremultiplied = 2;  // colours have to be multiplied by alpha
const uint layer_is_float = 4;         // the format can hold NaN, infinities and negatives
// What only the special kernels do:
const uint layer_cylinder = 8, layer_sphere = 16;  // curved: see LayerView::origin
const uint layer_minified = 32;                    // some pixel sees more than two texels side by side: they are averaged
const uint layer_tinted = 64;                      // colour scale and bias
const uint layer_replaces = 128;                   // where it is seen, the layer before it is not
const uint layer_special = layer_cylinder | layer_sphere | layer_minified | layer_tinted | layer_replaces;
const uint most_taps = 8;                          // of an averaged footprint, along each side: 16 texels

// Projection layers (turned, at infinity) and quads (a plane in space) are both projective maps of directions, so one 3×3 matrix from
// lens coordinates to texels says all: with p and D as in shaders/geometry.glsl (lens_position, lens_denominator) of a colour,
//   (a, b, w) = texel_from_lens * (p.x, p.y, D),  texel = (a, b) / w, seen where w > 0 and the texel lies within low..high.
// The division by D that the lens formula asks for cancels.
struct LayerView {
    vec3 texel_from_lens[9];       // rows; red 0..2, green 3..5, blue 6..8
    vec2 low, high;                // the sub-image, texels
    vec2 clamp_low, clamp_high;    // half a texel inside: no neighbour outside of the sub-image is read
    float cd_per_unit, offset_cd;  // cd/m² = value * cd_per_unit + offset_cd * coverage
    uint flags;
    // Curved layers: the matrix's (a, b, w) is a direction (x, y, z) in the surface's axes. From `origin` it meets the cylinder or sphere of
    // `radius` at a longitude and a height (cylinder) or latitude: texel = that * texel_scale + texel_bias.
    vec3 origin;
    float radius;
    vec2 texel_scale, texel_bias;
    vec4 colour_scale, colour_bias;
};

#ifdef __cplusplus
static_assert(sizeof(LayerView) == 216, "scalar layout: the GLSL side must agree");
}  // namespace entoptic::compositor
#endif

#endif
