// The lists of the blur by local means.
#ifndef ENTOPTIC_PERCEPTION_ACUITY_LOCAL_BLUR_LISTS_GLSL
#define ENTOPTIC_PERCEPTION_ACUITY_LOCAL_BLUR_LISTS_GLSL

#include "perception/acuity/tile_lists.glsl"

const uint list_rows = 0u;       // tiles whose blurred rows are needed
const uint list_columns = 1u;    // tiles to blur

#endif
