// Parameters of mes2; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_MESOPIC_MES2_PARAMS_H
#define ENTOPTIC_PERCEPTION_MESOPIC_MES2_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct Mes2Params {
    float strength;                // 0..1, multiplies the rods' share
    float photographic;            // 1: all that an eye in the scene sees; 0: only what the wearer's own eye does not do
    float sp_ratio;                // of the adapting light: scotopic over photopic luminance; 2.46 for daylight
    float local_mean_deg;          // diameter of the window of the local mean; 0: each pixel by itself
    float tint_r, tint_g, tint_b;  // colour of rod vision; divided by its own luminance before use
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
