// What the passes of the foveated stage share. Scalar layout, one struct for C++ and GLSL.
#ifndef ENTOPTIC_PERCEPTION_FOVEATION_FOVEATION_GPU_H
#define ENTOPTIC_PERCEPTION_FOVEATION_FOVEATION_GPU_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

// The gaze's axes in those of the view: a direction of the foveated image is x right + y up + z back there.
struct FoveatedView {
    vec3 right, up, back;
};

// One texel of the foveated image: what it shows, in the gaze's axes, and its solid angle; constant.
struct FoveatedTexel {
    vec3 direction;
    float sr;  // 0 outside of the disc
};

// Pixels of the view and of the foveated image.
struct FoveationPush {
    uint width, height;
    uint side;
    uint has_depth;
};

// Whether any model changed the foveated picture of this frame, and the dispatch that brings it back.
struct FoveationGate {
    uint x, y, z;  // VkDispatchIndirectCommand
    uint changed;
};

// Width of a texel, in pixels of the view, up to which every pixel is some texel's nearest and that texel its own: then both ways are exact.
// Beyond, filters take over.
const float nearest_until_px = 0.9f, filtered_from_px = 1.1f;

#ifdef __cplusplus
static_assert(sizeof(FoveatedView) == 36 && sizeof(FoveatedTexel) == 16, "scalar layout: the GLSL side must agree");
}  // namespace entoptic::perception
#endif

#endif
