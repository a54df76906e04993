// Parameters of liu_range; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_DOF_LIU_RANGE_PARAMS_H
#define ENTOPTIC_PERCEPTION_DOF_LIU_RANGE_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct LiuRangeParams {
    float strength;         // 0..1, multiplies the disc's width
    float focus_dioptre;    // fixed focus, 1/m; negative: the eyes focus on what they look at
    float use_vergence;     // 1: on where the lines of sight meet, when that is measured
    float focus_tau_s;      // time constant of the focus
    float max_radius_px;    // disc at the end of the scale, at 13.85 pixels per degree
    float lca;              // 1: rows of the kernel are coloured
    float roulette;         // 1: discs are sampled
    float as_printed;       // 1: equation 13 in metres
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
