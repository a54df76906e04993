// Parameters of krawczyk_larson; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_ACUITY_KRAWCZYK_LARSON_PARAMS_H
#define ENTOPTIC_PERCEPTION_ACUITY_KRAWCZYK_LARSON_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct KrawczykLarsonParams {
    float strength;    // 0..1, multiplies sigma
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
