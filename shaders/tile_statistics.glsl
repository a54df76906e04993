// For the pass that writes the eye image: cleans a pixel and reduces the workgroup's 32×8 pixels to one TileStatistics.
// The reduction is a fixed tree: the same input gives the same bits.
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

shared TileStatistics tile_parts[tile_width * tile_height];

// Every invocation of the workgroup must call this. `inside`: the pixel is inside the image and visible; `solid_angle` in sr.
// The result is valid in invocation 0 after the call.
TileStatistics reduce_tile(vec3 c, bool inside, bool changed, float solid_angle) {
    const uint i = gl_LocalInvocationIndex;
    const float y = luminance(c);
    tile_parts[i] = inside ? TileStatistics(y * solid_angle, solid_angle, y, y, max(c.x, max(c.y, c.z)), changed ? 1u : 0u, 1u)
                           : TileStatistics(0.0, 0.0, 3e38, 0.0, 0.0, 0u, 0u);
    for (uint stride = tile_width * tile_height / 2; stride > 0; stride /= 2) {
        barrier();
        if (i < stride) {
            const TileStatistics b = tile_parts[i + stride];
            TileStatistics a = tile_parts[i];
            a.sum_y_sr += b.sum_y_sr;
            a.sum_sr += b.sum_sr;
            a.min_y = min(a.min_y, b.min_y);
            a.max_y = max(a.max_y, b.max_y);
            a.max_channel = max(a.max_channel, b.max_channel);
            a.cleaned += b.cleaned;
            a.visible += b.visible;
            tile_parts[i] = a;
        }
    }
    barrier();
    return tile_parts[0];
}

#endif
