#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The far kernel of one pupil diameter on the glare grid from the far part of its profile, per sr, averaged over each texel.
// Grid 0: red + i green, grid 1: blue.
#include "perception/glare/glare_gpu.h"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Profile { RadialEntry profile[]; };
layout(scalar, binding = 1) writeonly buffer Grid { vec2 grid[]; };

layout(scalar, push_constant) uniform PushBlock { KernelPush push; };

#include "perception/glare/glare_radial.glsl"

vec3 kernel(vec2 offset) { return radial_kernel(length(offset), push.profile, push.weights); }

void main() {
    const uvec2 at = gl_GlobalInvocationID.xy;
    const uint n = gl_NumWorkGroups.y;       // texels of a side
    const ivec2 texel = ivec2(at) - ivec2(greaterThanEqual(at, uvec2(n / 2))) * int(n);
    const int far = max(abs(texel.x), abs(texel.y));
    const int samples = far <= 4 ? 8 : far <= 16 ? 4 : far <= 64 ? 2 : 1;
    vec3 sum = vec3(0.0);
    for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) sum += kernel((vec2(texel) + (vec2(i, j) + 0.5) / float(samples) - 0.5) * push.pitch);
    sum /= float(samples * samples);
    const uint to = at.y * glare_row + at.x;
    grid[to] = sum.rg;
    grid[to + glare_plane] = vec2(sum.b, 0.0);
}
