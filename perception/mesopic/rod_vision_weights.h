// What rods make of a colour. Scalar layout, one struct for C++ and GLSL.
#ifndef ENTOPTIC_PERCEPTION_MESOPIC_ROD_VISION_WEIGHTS_H
#define ENTOPTIC_PERCEPTION_MESOPIC_ROD_VISION_WEIGHTS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct RodVision {
    float weight_r, weight_g, weight_b;   // scotopic luminance of linear BT.709, 1 for white
    float gain;                           // multiplies it; 1: white has the same luminance for rods and cones
    float rod_lumen;                      // weight of the rods' share in the normalisation; 1: a plain blend
    float tint_r, tint_g, tint_b;         // colour of rod vision, of luminance 1
};

#ifdef __cplusplus
static_assert(sizeof(RodVision) == 32, "scalar layout: the GLSL side must agree");
}  // namespace entoptic::perception
#endif

#endif
