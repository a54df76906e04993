// State of the observer that models share, one a view. Scalar layout, one struct for C++ and GLSL.
#ifndef ENTOPTIC_PERCEPTION_OBSERVER_STATE_H
#define ENTOPTIC_PERCEPTION_OBSERVER_STATE_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct ObserverState {
    float adaptation_cd_m2;     // A: what the eye is adapted to; 0 before the first frame
    float target_cd_m2;         // where it goes: gaze-weighted luminance of this frame
    uint initialised;           // 0 before the first frame
    uint reserved;
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
