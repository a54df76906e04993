#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Nodes to texels of the glare grid, in gather form, so that the sum has one order. Patches 2 p and 2 p + 1 become real and imaginary part of
// grid p: the kernel is real, so one complex transform convolves both.
#include "perception/glare/glare_gpu.h"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Nodes { float nodes[]; };
layout(scalar, binding = 1) readonly buffer Offsets { uint offsets[]; };       // patch, row, column
layout(scalar, binding = 2) readonly buffer Entries { SplatEntry entries[]; };
layout(scalar, binding = 3) writeonly buffer Grid { vec2 grid[]; };

layout(scalar, push_constant) uniform PushBlock { SplatPush push; };

vec3 gathered(uint patch_index, uint texel) {
    if (patch_index >= push.patches) return vec3(0.0);
    const uint list = patch_index * (glare_n * glare_n) + texel;
    const uint end = offsets[list + 1];
    vec3 sum = vec3(0.0);
    for (uint i = offsets[list]; i < end; ++i) {
        const SplatEntry entry = entries[i];
        const uint at = entry.node * push.channels;
        const vec3 value = push.channels == 3 ? vec3(nodes[at], nodes[at + 1], nodes[at + 2]) : vec3(nodes[at], 0.0, 0.0);
        sum += entry.weight * value;
    }
    return sum;
}

void main() {
    const uint x = push.first_column + gl_GlobalInvocationID.x, y = push.first_row + gl_GlobalInvocationID.y, pair = gl_GlobalInvocationID.z;
    if (gl_GlobalInvocationID.x >= push.columns || gl_GlobalInvocationID.y >= push.rows) return;
    const vec3 a = gathered(2 * pair, y * glare_n + x), b = gathered(2 * pair + 1, y * glare_n + x);
    const uint at = pair * push.channels * glare_plane + y * glare_row + x;
    grid[at] = vec2(a.x, b.x);
    if (push.channels == 1) return;
    grid[at + glare_plane] = vec2(a.y, b.y);
    grid[at + 2 * glare_plane] = vec2(a.z, b.z);
}
