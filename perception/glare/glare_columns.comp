#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Columns of the glare grid. Groups: (columns / lines, grids).
//   transform   forward, in place
//   convolve    forward, times the kernel's real spectrum (between two pupil diameters), inverse
//   kernel      forward; real and imaginary part are the spectra of two symmetric kernels and go to their planes
layout(local_size_x_id = 2, local_size_y_id = 3) in;
const uint mode_transform = 0, mode_convolve = 1, mode_kernel = 2;
layout(constant_id = 0) const uint mode = 0;
layout(constant_id = 1) const uint fft_n = 512;
const uint lines = gl_WorkGroupSize.y;

layout(scalar, binding = 0) readonly buffer Input { vec2 source[]; };
layout(scalar, binding = 1) buffer Output { vec2 grid[]; };
layout(scalar, binding = 2) readonly buffer Twiddle { vec2 twiddle[]; };
layout(scalar, binding = 3) buffer Spectrum { float spectrum[]; };    // key, channel, plane

#include "perception/glare/fft_line.glsl"

#include "perception/glare/glare_math.glsl"

layout(scalar, push_constant) uniform PushBlock { FftPush push; };

void main() {
    const uint j = gl_LocalInvocationID.x, line = gl_LocalInvocationID.y;
    const uint column = gl_WorkGroupID.x * lines + line;
    const uint plane = gl_WorkGroupID.y;
    const uint channel = plane % 3;
    const uint from = (push.input_channels == 1 ? plane / 3 : plane) * glare_plane + column;
    const uint to = plane * glare_plane + column;
    vec2 v[8];
    for (uint r = 0; r < 8; ++r) {
        const uint row = j + fft_n / 8 * r;
        v[r] = row - push.first_row < push.rows ? source[from + row * glare_row] : vec2(0.0);
    }
    fft_line(v, j, line, 1.0);
    if (mode == mode_kernel) {
        // Of two real, symmetric kernels a and b the transform of a + i b is A + i B with real A and B.
        const uint real_plane = (3 * push.first_key + 2 * plane) * glare_plane + column;
        const float across = sharpening(float(column) / float(fft_n), push.damping, push.order) / float(fft_n * fft_n);
        for (uint r = 0; r < 8; ++r) {
            const float scale = across * sharpening(float(j + fft_n / 8 * r) / float(fft_n), push.damping, push.order);
            const uint at = real_plane + (j + fft_n / 8 * r) * glare_row;
            spectrum[at] = v[r].x * scale;
            if (plane == 0) spectrum[at + glare_plane] = v[r].y * scale;
        }
        return;
    }
    if (mode == mode_convolve) {
        const uint first = (3 * push.first_key + channel) * glare_plane + column;
        const uint second = (3 * push.second_key + channel) * glare_plane + column;
        for (uint r = 0; r < 8; ++r) {
            const uint at = (j + fft_n / 8 * r) * glare_row;
            v[r] *= mix(spectrum[first + at], spectrum[second + at], push.blend);
        }
        fft_line(v, j, line, -1.0);
    }
    for (uint r = 0; r < 8; ++r) {
        const uint row = j + fft_n / 8 * r;
        if (row - push.first_row < push.rows) grid[to + row * glare_row] = v[r];
    }
}
