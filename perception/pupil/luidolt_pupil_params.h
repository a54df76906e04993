// Parameters of luidolt_pupil; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_PUPIL_LUIDOLT_PUPIL_PARAMS_H
#define ENTOPTIC_PERCEPTION_PUPIL_LUIDOLT_PUPIL_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct LuidoltPupilParams {
    float white_mm;           // what the tracker measures while the panel is white
    float black_mm;           // and while it is black
    float least_mm, most_mm;  // the simulated pupils that these stand for
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
