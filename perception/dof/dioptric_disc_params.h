// Parameters of dioptric_disc; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_DOF_DIOPTRIC_DISC_PARAMS_H
#define ENTOPTIC_PERCEPTION_DOF_DIOPTRIC_DISC_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct DioptricDiscParams {
    float strength;         // 0..1, multiplies the disc's width
    float focus_dioptre;    // fixed focus, 1/m; negative: the eyes focus on what they look at
    float use_vergence;     // 1: on where the lines of sight meet, when that is measured
    float focus_tau_s;      // time constant of the focus
    float deadband_dioptre; // defocus that the eye does not notice
    float max_radius_px;    // widest disc
    float lca;              // 1: each colour has its own focus
    float roulette;         // 1: discs are sampled
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
