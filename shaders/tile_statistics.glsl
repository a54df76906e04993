// For the pass that writes the eye image: cleans a pixel and packs it. The tiles' statistics are made by perception/tiles.comp, which
// Stage::record() runs first: a reduction in the workgroup of the writing pass costs 850 ms of CPU a frame on lavapipe (barriers), the
// extra pass 44 ms (docs/decisions).
#ifndef ENTOPTIC_SHADERS_TILE_STATISTICS_GLSL
#define ENTOPTIC_SHADERS_TILE_STATISTICS_GLSL

#include "shaders/colour_math.glsl"
#include "shaders/scene_statistics.h"

// NaN and negatives become 0, infinities and what exceeds the range becomes max_scene_cd_m2; `changed` tells.
vec3 clean_scene_colour(vec3 c, out bool changed) {
    // A comparison with NaN is false, so NaN fails the first test.
    vec3 cleaned = vec3(c.x > 0.0 ? min(c.x, max_scene_cd_m2) : 0.0, c.y > 0.0 ? min(c.y, max_scene_cd_m2) : 0.0,
                        c.z > 0.0 ? min(c.z, max_scene_cd_m2) : 0.0);
    changed = !(c.x >= 0.0 && c.y >= 0.0 && c.z >= 0.0 && c.x <= max_scene_cd_m2 && c.y <= max_scene_cd_m2 && c.z <= max_scene_cd_m2);
    return cleaned;
}

// The i-th point of a glance at a tile of `extent` pixels, from the tile's corner.
uvec2 glance_point(uvec2 extent, uint i) {
    return uvec2((2u * (i % glance_columns) + 1u) * extent.x / (2u * glance_columns), (2u * (i / glance_columns) + 1u) * extent.y / (2u * glance_rows));
}

// The vec4 of an eye-image pixel: w is pixel_hidden, pixel_visible or pixel_cleaned.
vec4 scene_pixel(vec3 cleaned, bool visible, bool changed) {
    return visible ? vec4(cleaned, changed ? pixel_cleaned : pixel_visible) : vec4(0.0, 0.0, 0.0, pixel_hidden);
}

#endif
