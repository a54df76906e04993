// Parameters of jacobs_bands; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_ACUITY_JACOBS_BANDS_PARAMS_H
#define ENTOPTIC_PERCEPTION_ACUITY_JACOBS_BANDS_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct JacobsBandsParams {
    float strength;              // 0..1, multiplies sigma
    float photographic;          // 1: all that an eye in the scene loses; 0: only what the wearer's own eye does not lose
    float range;                 // 0: 0.005 .. 5 cd/m² (CIE 191), 1: 0.01 .. 1 (appendix A), 2: 0.001 .. 10 (section 2.3)
    float local_mean_deg;        // diameter of the window of the local mean
    float randomness;            // g of equation 15
    float cell_deg, rate_hz;     // size of the patches of its noise, and how often it is drawn anew
    float eccentricity_per_deg;  // widening of the blur with the angle from the gaze, 1/°
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
