#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Two patches of the pupil plane, one real and one imaginary: its particles as points under a Hann window, less their mean, so that the
// light that goes straight on does not drown the rest. A point is spread over 4 x 4 samples by a cubic B-spline, whose transform
// the pass "structure" divides out. The discs' own shape comes in closed form in the pass "kernel": the transform of a mask of equal discs is the
// transform of their centres times that of one disc, and so nothing of the discs' edges aliases (trap L12).
#include "perception/glare/luidolt_spectral_gpu.h"
#include "perception/glare/luidolt_spectral_math.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(scalar, binding = 0) readonly buffer Offsets { uint offsets[]; };       // patch, cell row, cell column
layout(scalar, binding = 1) readonly buffer Particles { vec2 particles[]; };   // samples from the patch's corner
layout(scalar, binding = 2) readonly buffer Mean { vec2 mean[]; };             // patch: particles a sample, sum of squared windows
layout(scalar, binding = 3) writeonly buffer Grid { vec2 grid[]; };

layout(scalar, push_constant) uniform PushBlock { StructurePush push; };

float hann(vec2 at) {
    const vec2 h = 0.5 - 0.5 * cos(6.283185307179586 / float(glare_n) * at);
    return h.x * h.y;
}

float plane_of_points(uint patch_index, uvec2 sample_at) {
    const uint cell = (patch_index * cells_per_side + sample_at.y / cell_samples) * cells_per_side + sample_at.x / cell_samples;
    float sum = -mean[patch_index].x * hann(vec2(sample_at));
    const uint end = offsets[cell + 1];
    for (uint i = offsets[cell]; i < end; ++i) {
        const vec2 d = vec2(sample_at) - particles[i];
        sum += hann(particles[i]) * bspline(d.x) * bspline(d.y);
    }
    return sum;
}

void main() {
    const uvec2 at = gl_GlobalInvocationID.xy;
    const uint pair = push.first_pair + gl_GlobalInvocationID.z;
    grid[gl_GlobalInvocationID.z * glare_plane + at.y * glare_row + at.x] =
        vec2(plane_of_points(2 * pair, at), plane_of_points(2 * pair + 1, at));
}
