// Parameters of pattanaik_slow; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_ADAPTATION_PATTANAIK_SLOW_PARAMS_H
#define ENTOPTIC_PERCEPTION_ADAPTATION_PATTANAIK_SLOW_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct PattanaikSlowParams {
    float sigma_gaze_deg;    // standard deviation of the Gaussian around the gaze, degrees of visual angle
    float wide_share;        // share 0..1 of the whole field's mean in the target; counts when `retinal` is 0
    float floor_cd_m2;       // the eye never adapts below this
    float clip_over_median;  // tiles brighter than this times the median tile count as that much
    float retinal;           // 1: driven by the light on the fovea, straylight included; 0: by the scene's
    float speed;             // multiplies time
    float tau_rod_s;         // time constant of the neural part, rods, s
    float tau_cone_s;        // the same, cones, s
    float time_lapse;        // multiplies time for the pigments only
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
