#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Rows of the glare grid, in place. Groups: (rows / 4, grids).
layout(local_size_x = 64, local_size_y = 4) in;
layout(constant_id = 0) const uint inverse = 0;

layout(scalar, binding = 0) buffer Grid { vec2 grid[]; };
layout(scalar, binding = 1) readonly buffer Twiddle { vec2 twiddle[]; };

#include "perception/glare/fft512.glsl"

layout(scalar, push_constant) uniform PushBlock { FftPush push; };

void main() {
    const uint j = gl_LocalInvocationID.x, line = gl_LocalInvocationID.y;
    const uint row = gl_WorkGroupID.x * fft_lines + line;
    const bool inside = row < push.rows;
    const uint at = gl_WorkGroupID.y * glare_plane + (push.first_row + min(row, push.rows - 1)) * glare_row + j;
    vec2 v[8];
    for (uint r = 0; r < 8; ++r) v[r] = grid[at + 64 * r];
    fft512(v, j, line, inverse != 0 ? -1.0 : 1.0);
    if (!inside) return;
    for (uint r = 0; r < 8; ++r) grid[at + 64 * r] = v[r];
}
