// Parameters of key_reinhard; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_TONE_KEY_REINHARD_PARAMS_H
#define ENTOPTIC_PERCEPTION_TONE_KEY_REINHARD_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct KeyReinhardParams {
    float key_scale;      // multiplies the automatic key
    float as_printed;     // 1: multiplies by the adaptation luminance as Luidolt 2020 section 4.1 prints it
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
