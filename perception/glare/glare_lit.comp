#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Lists the texels of the grid that hold light, up to `most` and counts on. The order varies; the next pass sorts.
#include "perception/glare/glare_gpu.h"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Grid { vec2 grid[]; };
layout(scalar, binding = 1) buffer Lit { uint lit_count; LitTexel lit[]; };

layout(scalar, push_constant) uniform PushBlock { BillboardPush push; };

void main() {
    const uint x = gl_GlobalInvocationID.x, y = push.first_row + gl_GlobalInvocationID.y, pair = gl_GlobalInvocationID.z;
    const uint at = 3 * pair * glare_plane + y * glare_row + x;
    const vec2 r = grid[at], g = grid[at + glare_plane], b = grid[at + 2 * glare_plane];
    if (r == vec2(0.0) && g == vec2(0.0) && b == vec2(0.0)) return;
    if (lit_count > push.most) return;     // read without order: only saves work
    const uint slot = atomicAdd(lit_count, 1u);
    if (slot >= push.most) return;
    lit[slot].place = (pair * glare_n + y) * glare_n + x;
    lit[slot].of[0] = vec3(r.x, g.x, b.x);
    lit[slot].of[1] = vec3(r.y, g.y, b.y);
}
