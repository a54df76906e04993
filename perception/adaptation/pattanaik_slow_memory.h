// What pattanaik_slow remembers of each eye; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_ADAPTATION_PATTANAIK_SLOW_MEMORY_H
#define ENTOPTIC_PERCEPTION_ADAPTATION_PATTANAIK_SLOW_MEMORY_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct PattanaikSlowMemory {
    float neural_cd_m2;        // the fast part's state; 0: never set
    float rod_unbleached;      // share of rod pigment that is there: as little as 4e-10 in the sun
    float cone_bleached;       // share of cone pigment that is not: as little as 5e-13 at night
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
