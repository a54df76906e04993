#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Structure factor of a pair of patches: power spectrum of their points over its expected value, so that 1 is the smooth halo.
// Two bins a sample, with the weights 1 2 1, symmetric about the zero frequency.
#include "perception/glare/luidolt_spectral_gpu.h"
#include "perception/glare/luidolt_spectral_math.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(scalar, binding = 0) readonly buffer Grid { vec2 grid[]; };
layout(scalar, binding = 1) readonly buffer Mean { vec2 mean[]; };
layout(scalar, binding = 2) writeonly buffer Structure { float structure[]; };

layout(scalar, push_constant) uniform PushBlock { StructurePush push; };

// The real patches a and b are packed as a + i b: |Z(k)|^2 + |Z(-k)|^2 = 2 (|A|^2 + |B|^2).
float power(uint plane, ivec2 k) {
    const uvec2 p = uvec2(k + int(glare_n)) % glare_n, q = uvec2(int(glare_n) - k) % glare_n;
    const vec2 z = grid[plane * glare_plane + p.y * glare_row + p.x], w = grid[plane * glare_plane + q.y * glare_row + q.x];
    const float spread = sinc(float(k.x) / float(glare_n)) * sinc(float(k.y) / float(glare_n));
    const float spline = spread * spread * spread * spread;
    return 0.5 * (dot(z, z) + dot(w, w)) / (spline * spline);
}

void main() {
    const ivec2 centre = (ivec2(gl_GlobalInvocationID.xy) - int(structure_n / 2)) * 2;
    const uint pair = push.first_pair + gl_GlobalInvocationID.z;
    float sum = 0.0;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
            sum += float((2 - abs(dx)) * (2 - abs(dy))) / 16.0 * power(gl_GlobalInvocationID.z, centre + ivec2(dx, dy));
    const float expected = mean[2 * pair].y + mean[2 * pair + 1].y;
    const uint at = pair * structure_n * structure_n + gl_GlobalInvocationID.y * structure_n + gl_GlobalInvocationID.x;
    structure[at] = expected > 0.0 ? sum / expected : 1.0;
}
