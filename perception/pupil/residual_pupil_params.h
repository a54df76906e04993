// Parameters of residual_pupil; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_PUPIL_RESIDUAL_PUPIL_PARAMS_H
#define ENTOPTIC_PERCEPTION_PUPIL_RESIDUAL_PUPIL_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct ResidualPupilParams {
    float age;                // years
    float least_mm, most_mm;  // limits of the simulated pupil
    float constriction_mm_s;  // fastest change
    float dilation_mm_s;
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
