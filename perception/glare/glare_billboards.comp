#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The kernel drawn at each lit texel, scaled by its light: what the transforms make of few sources, to rounding. In place of them.
#include "perception/glare/glare_gpu.h"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Lit { uint lit_count; LitTexel lit[]; };
layout(scalar, binding = 1) readonly buffer Billboard { vec3 billboard[]; };      // key, row, column
layout(scalar, binding = 2) writeonly buffer Grid { vec2 grid[]; };

layout(scalar, push_constant) uniform PushBlock { BillboardPush push; };

vec3 kernel(uint key, uvec2 offset) { return billboard[(key * glare_n + offset.y) * glare_n + offset.x]; }

void main() {
    const uint x = gl_GlobalInvocationID.x, y = push.first_row + gl_GlobalInvocationID.y, pair = gl_GlobalInvocationID.z;
    const uint of_grid = glare_n * glare_n, count = lit_count, n = 64 * gl_NumWorkGroups.x;      // texels of a side
    vec3 first = vec3(0.0), second = vec3(0.0);
    for (uint i = 0; i < count; ++i) {
        const LitTexel texel = lit[i];
        if (texel.place / of_grid != pair) continue;
        const uvec2 offset = uvec2(x - texel.place % glare_n, y - texel.place / glare_n % glare_n) & (n - 1);
        vec3 k = kernel(push.first_key, offset);
        if (push.blend > 0.0) k = mix(k, kernel(push.second_key, offset), push.blend);
        first += k * texel.of[0];
        second += k * texel.of[1];
    }
    const uint at = 3 * pair * glare_plane + y * glare_row + x;
    grid[at] = vec2(first.r, second.r);
    grid[at + glare_plane] = vec2(first.g, second.g);
    grid[at + 2 * glare_plane] = vec2(first.b, second.b);
}
