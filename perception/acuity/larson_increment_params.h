// Parameters of larson_increment; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_ACUITY_LARSON_INCREMENT_PARAMS_H
#define ENTOPTIC_PERCEPTION_ACUITY_LARSON_INCREMENT_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct LarsonIncrementParams {
    float strength;          // 0..1, multiplies sigma
    float photographic;      // 1: all that an eye in the scene loses; 0: only what the wearer's own eye does not lose
    float local_mean_deg;    // diameter of the window of the local mean
    float randomness;        // g: log luminance varies by 3 g decades, one standard deviation
    float cell_deg, rate_hz; // size of the patches of that noise, and how often it is drawn anew
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
