#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The window along a row of cells: weighted sums of light and of solid angle.

#include "perception/local_mean_math.glsl"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Cells { LocalCell cells[]; };
layout(scalar, binding = 1) writeonly buffer Rows { vec2 rows[]; };

layout(scalar, push_constant) uniform Push {
    LocalMeanGrid grid;
    float diameter_deg;
} push;

void main() {
    const LocalMeanGrid g = push.grid;
    const uint n = gl_GlobalInvocationID.x, all = g.nodes_x * g.nodes_y, first = gl_GlobalInvocationID.z * all;
    if (n >= all) return;
    const int x = int(n % g.nodes_x);
    const float sigma = node_sigma(push.diameter_deg, cells[first + n].ppd, g.cell);
    const int radius = node_radius(sigma);
    vec2 sum = vec2(0.0);
    for (int k = max(-radius, -x); k <= min(radius, int(g.nodes_x) - 1 - x); ++k) {
        const LocalCell cell = cells[int(first + n) + k];
        sum += exp(-0.5 * float(k * k) / (sigma * sigma)) * vec2(cell.y_sr, cell.sr);
    }
    rows[first + n] = sum;
}
