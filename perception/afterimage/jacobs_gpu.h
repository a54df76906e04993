// What the passes of jacobs share. Scalar layout, one struct for C++ and GLSL.
#ifndef ENTOPTIC_PERCEPTION_AFTERIMAGE_JACOBS_GPU_H
#define ENTOPTIC_PERCEPTION_AFTERIMAGE_JACOBS_GPU_H

#include "perception/afterimage/jacobs_params.h"
#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

const uint observe_width = 32, observe_height = 4;     // a workgroup of cells
const uint dispatch_observe = 0, dispatch_mark = 1, dispatch_apply = 2;   // of Gate::dispatch
const uint most_samples = 8;                           // pixels of a cell, an axis

// Where the states of the frame before come from.
const uint begin_stored = 0;    // they are kept
const uint begin_steady = 1;    // they jump to where this light keeps them
const uint begin_adapted = 2;   // first frame: the eye was adapted to an even field of its adaptation luminance

// The map: square, `size` cells a side, the fovea in its middle.
struct RetinaMap {
    uint size;
    float cell_rad;     // side of a cell
    float reach;        // radius of what the map holds, as length(at) of retina_of_direction()
};

// Kept between frames.
struct RetinaStatus {
    uint rested;              // 1: all states are 0, whatever is stored
    uint awake;               // this frame: a state is not 0
    uint added_bits;          // this frame: largest added share; bits of a float >= 0, which order like the float
    uint common_bits;         // largest |mean gain|
    uint spread_bits;         // largest difference of two cones' gains
};

struct ObservePush {
    JacobsParams params;
    RetinaMap map;
    vec3 gaze;
    float dt_s;               // finite, >= 0
    uint view, begin, samples;
    float lid_open;           // 0..1
    float white_cd_m2;
};

struct MarkPush {
    RetinaMap map;
    vec3 gaze;
    uint view, tiles_x, tiles_y;
};

struct ApplyPush {
    RetinaMap map;
    vec3 gaze;
    uint view, tiles_x, tiles_y;
    float white_cd_m2, black_cd_m2;
};

#ifdef __cplusplus
static_assert(sizeof(ObservePush) <= 128 && sizeof(ApplyPush) <= 128);
}  // namespace entoptic::perception
#endif

#endif
