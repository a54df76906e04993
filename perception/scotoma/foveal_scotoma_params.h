// Parameters of foveal_scotoma; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_SCOTOMA_FOVEAL_SCOTOMA_PARAMS_H
#define ENTOPTIC_PERCEPTION_SCOTOMA_FOVEAL_SCOTOMA_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct FovealScotomaParams {
    float strength;      // 0..1
    float photographic;  // 1: the whole scotoma of an eye in the scene; 0: only what the wearer's own eye does not have at the panel
    float inner_deg;     // no rods within this angle from the gaze
    float outer_deg;     // all rods beyond this one
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
