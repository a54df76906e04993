// What fraunhofer_mask's C++ and its shaders say to each other. Scalar layout.
#ifndef ENTOPTIC_PERCEPTION_GLARE_FRAUNHOFER_MASK_GPU_H
#define ENTOPTIC_PERCEPTION_GLARE_FRAUNHOFER_MASK_GPU_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct MaskKernelPush {
    float pitch, near;             // rad
    float strength;
    uint first_entry;              // of the table
};

struct MaskNearPush {
    uint width, height, tiles_x, tiles_y;
    uint zones;
    uint first_entry, second_entry;    // of the tables between which the eye is, of zone 0; the other zones follow
    float blend;                   // 0: first .. 1: second
    float strength;
    float near;                    // rad
    float near_from;               // as in TilesPush
    uint leaves;                   // 1: what is diffracted leaves its place
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
