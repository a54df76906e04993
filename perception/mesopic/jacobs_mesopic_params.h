// Parameters of jacobs_mesopic; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_MESOPIC_JACOBS_MESOPIC_PARAMS_H
#define ENTOPTIC_PERCEPTION_MESOPIC_JACOBS_MESOPIC_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct JacobsMesopicParams {
    float strength;                // 0..1, multiplies the rods' share
    float photographic;            // 1: all that an eye in the scene sees; 0: only what the wearer's own eye does not do
    float range;                   // 0: 0.005 .. 5 cd/m² (CIE 191), 1: 0.01 .. 1 (appendix A), 2: 0.001 .. 10 (section 2.3)
    float local_mean_deg;          // diameter of the window of the local mean; 0: each pixel by itself
    float tint_r, tint_g, tint_b;  // colour of rod vision; divided by its own luminance before use
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
