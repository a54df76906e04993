// Parameters of cie135; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_GLARE_CIE135_PARAMS_H
#define ENTOPTIC_PERCEPTION_GLARE_CIE135_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct Cie135Params {
    float strength;        // times the scattered light; 1 is the eye that the other parameters describe
    float age;             // years
    float pigment;         // 0 very dark, 0.5 brown, 1 green, 1.2 light blue
    float angle_scale;     // enlarges the kernel
    float texel_px;        // least width of a texel of the glare grid, eye-image pixels
    float near_px;         // radius of the near field that is done at full resolution, pixels
    float near_from;       // photographic: light above this many times the adaptation luminance has a near field
    float rescatter;       // share of the wearer's own scatter of the drawn halo that is taken away
    float photographic;    // 1: the whole scene is scattered; 0: only what the panel cannot send
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
