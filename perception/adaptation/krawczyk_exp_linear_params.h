// Parameters of krawczyk_exp_linear; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_ADAPTATION_KRAWCZYK_EXP_LINEAR_PARAMS_H
#define ENTOPTIC_PERCEPTION_ADAPTATION_KRAWCZYK_EXP_LINEAR_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct KrawczykExpLinearParams {
    float sigma_gaze_deg;    // standard deviation of the Gaussian around the gaze, degrees of visual angle
    float wide_share;        // share 0..1 of the whole field's mean in the target
    float tau_rod_s;         // time constant of rod vision, s
    float tau_cone_s;        // time constant of cone vision, s
    float speed;             // multiplies time
    float floor_cd_m2;       // the eye never adapts below this
    float clip_over_median;  // tiles brighter than this times the median tile count as that much
    float as_printed;        // 1: weights that are not normalised (trap L2), pixels instead of solid angle, no wide field, no clip
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
