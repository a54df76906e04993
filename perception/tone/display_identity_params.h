// Parameters of display_identity; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_TONE_DISPLAY_IDENTITY_PARAMS_H
#define ENTOPTIC_PERCEPTION_TONE_DISPLAY_IDENTITY_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct DisplayIdentityParams {
    float night_exponent;     // scenes below the panel's black are shown at A^(1 - night_exponent)
    float day_cd_m2;          // where the adapted luminance of scenes above the panel's white lands, at itself
    float day_exponent;       // and how it grows with them
    float knee;               // share of white at which highlights begin to be compressed
    float smoothing_s;        // time constant of the scene's statistics
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
