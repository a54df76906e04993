// Parameters of luidolt_eq12; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_ACUITY_LUIDOLT_EQ12_PARAMS_H
#define ENTOPTIC_PERCEPTION_ACUITY_LUIDOLT_EQ12_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct LuidoltEq12Params {
    float strength;    // 0..1, multiplies sigma
    float as_printed;  // 1: pixels instead of degrees (trap L14), two 1-D passes (trap L18), Lab with a and b kept
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
