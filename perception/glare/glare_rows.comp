#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Rows of the glare grid, in place. Groups: (rows / lines, grids).
layout(local_size_x_id = 2, local_size_y_id = 3) in;
layout(constant_id = 0) const uint inverse = 0;
layout(constant_id = 1) const uint fft_n = 512;
const uint lines = gl_WorkGroupSize.y;

layout(scalar, binding = 0) buffer Grid { vec2 grid[]; };
layout(scalar, binding = 1) readonly buffer Twiddle { vec2 twiddle[]; };

#include "perception/glare/fft_line.glsl"

layout(scalar, push_constant) uniform PushBlock { FftPush push; };

void main() {
    const uint j = gl_LocalInvocationID.x, line = gl_LocalInvocationID.y;
    const uint row = gl_WorkGroupID.x * lines + line;
    const bool inside = row < push.rows;
    const uint at = gl_WorkGroupID.y * glare_plane + (push.first_row + min(row, push.rows - 1)) * glare_row + j;
    vec2 v[8];
    for (uint r = 0; r < 8; ++r) v[r] = grid[at + fft_n / 8 * r];
    fft_line(v, j, line, inverse != 0 ? -1.0 : 1.0);
    if (!inside) return;
    for (uint r = 0; r < 8; ++r) grid[at + fft_n / 8 * r] = v[r];
}
