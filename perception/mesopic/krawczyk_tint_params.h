// Parameters of krawczyk_tint; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_MESOPIC_KRAWCZYK_TINT_PARAMS_H
#define ENTOPTIC_PERCEPTION_MESOPIC_KRAWCZYK_TINT_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct KrawczykTintParams {
    float strength;                // 0..1, multiplies the rods' share
    float photographic;            // 1: all that an eye in the scene sees; 0: only what the wearer's own eye does not do
    float tint_r, tint_g, tint_b;  // colour of rod vision; divided by its own luminance before use
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
