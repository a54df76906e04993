#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The blurred tiles go back into the scene. After a sampled gathering a second, small bokeh hides its noise: the mean of the 3x3 pixels
// around, of those at least as blurred, where the disc itself is wider than that.

#include "perception/dof/dof_gpu.h"
#include "perception/dof/dof_list.glsl"
#include "perception/dof/dof_math.glsl"

layout(local_size_x = tile_width, local_size_y = tile_height) in;

layout(constant_id = 0) const bool smooth_noise = false;

layout(scalar, binding = 0) writeonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer Pixels { DofPixel pixels[]; };
layout(scalar, binding = 2) readonly buffer Lists { uint lists[]; };
layout(scalar, binding = 3) readonly buffer Blurred { vec4 blurred[]; };

layout(scalar, push_constant) uniform Push {
    uint width, height, tiles_x, tiles_y;
} push;

void main() {
    const uint entry = gl_WorkGroupID.y * dof_list_row + gl_WorkGroupID.x;
    if (entry >= lists[0]) return;
    const uint t = lists[1u + entry], view = t / (push.tiles_x * push.tiles_y);
    const uvec2 corner = uvec2(t % push.tiles_x * tile_width, t / push.tiles_x % push.tiles_y * tile_height);
    const uvec2 at = corner + gl_LocalInvocationID.xy;
    if (at.x >= push.width || at.y >= push.height) return;
    const uint index = (view * push.height + at.y) * push.width + at.x;
    vec4 result = blurred[index];
    const float radius = pixels[index].radius_px.x;
    if (smooth_noise && radius > 1.5 && result.w != pixel_hidden) {
        // Within the tile only: what lies in another tile may not have been gathered.
        const uvec2 low = max(at, corner + 1u) - 1u, high = min(min(at + 1u, corner + uvec2(tile_width, tile_height) - 1u), uvec2(push.width, push.height) - 1u);
        vec4 sum = vec4(0.0);
        for (uint y = low.y; y <= high.y; ++y)
            for (uint x = low.x; x <= high.x; ++x) {
                const uint other = (view * push.height + y) * push.width + x;
                const float weight = pixels[other].radius_px.x >= 0.8 * radius && blurred[other].w != pixel_hidden ? 1.0 : 0.0;
                sum += weight * vec4(blurred[other].rgb, 1.0);
            }
        result.rgb = sum.rgb / sum.w;
    }
    scene[index] = result;
}
