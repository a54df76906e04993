// Parameters of rod_noise; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_NOISE_ROD_NOISE_PARAMS_H
#define ENTOPTIC_PERCEPTION_NOISE_ROD_NOISE_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct RodNoiseParams {
    float strength;       // multiplies the noise's contrast
    float photographic;   // 1: all the noise of an eye in the scene; 0: only what the wearer's own eye does not have at the panel
    float sp_ratio;       // scotopic over photopic luminance of the light
    float grain_deg;      // side of the square of retina over which rods are summed, and of the noise's patches
    float integration_s;  // time over which rods are summed, and after which the noise is another
    float efficiency;     // share of the quanta at the cornea that rods absorb
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
