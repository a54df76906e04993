#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Three planes of the work buffer to one of colours: the kernel in space, texel by texel from its middle, wrapped.
#include "perception/glare/glare_gpu.h"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Grid { vec2 grid[]; };
layout(scalar, binding = 1) writeonly buffer Billboard { vec3 billboard[]; };     // key, row, column

layout(scalar, push_constant) uniform PushBlock { BillboardPush push; };

void main() {
    const uvec2 at = gl_GlobalInvocationID.xy;
    const uint from = at.y * glare_row + at.x;
    billboard[(push.first_key * glare_n + at.y) * glare_n + at.x] = vec3(grid[from].x, grid[from + glare_plane].x, grid[from + 2 * glare_plane].x);
}
