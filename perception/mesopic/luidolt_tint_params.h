// Parameters of luidolt_tint; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_MESOPIC_LUIDOLT_TINT_PARAMS_H
#define ENTOPTIC_PERCEPTION_MESOPIC_LUIDOLT_TINT_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct LuidoltTintParams {
    float strength;                // 0..1, multiplies the rods' share
    float tint_r, tint_g, tint_b;  // colour of rod vision; divided by its own luminance before use
    float cut_cd_m2;               // adaptation above which there is no tint at all; 0: the formula's long tail stays
    float as_printed;              // 1: the tint is not normalised (trap L20)
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
