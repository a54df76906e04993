// Parameters of blink; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_EYELID_BLINK_PARAMS_H
#define ENTOPTIC_PERCEPTION_EYELID_BLINK_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct BlinkParams {
    float opening_mm;      // height of the open eye's slit
    float lid_red;         // share of red light that the closed lid lets through
    float lid_green_blue;  // the same for green and blue
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
