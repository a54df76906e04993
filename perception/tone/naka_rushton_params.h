// Parameters of naka_rushton; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_TONE_NAKA_RUSHTON_PARAMS_H
#define ENTOPTIC_PERCEPTION_TONE_NAKA_RUSHTON_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct NakaRushtonParams {
    float exponent;                // n
    float plateau_scale;           // multiplies the plateau M(A)
    float plateau;                 // above 0: M is this constant instead of M(A)
    float display_adaptation_cd_m2;// above 0: the wearer's eye, adapted to this, is undone: Ld = σ(Ad) (R/(1-R))^(1/n)
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
