#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The window along a column, and the mean: luminance in cd/m² at each node.

#include "perception/local_mean_math.glsl"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Cells { LocalCell cells[]; };
layout(scalar, binding = 1) readonly buffer Rows { vec2 rows[]; };
layout(scalar, binding = 2) writeonly buffer Means { float means[]; };

layout(scalar, push_constant) uniform Push {
    LocalMeanGrid grid;
    float diameter_deg;
} push;

void main() {
    const LocalMeanGrid g = push.grid;
    const uint n = gl_GlobalInvocationID.x, all = g.nodes_x * g.nodes_y, first = gl_GlobalInvocationID.z * all;
    if (n >= all) return;
    const int y = int(n / g.nodes_x);
    const float sigma = node_sigma(push.diameter_deg, cells[first + n].ppd, g.cell);
    const int radius = node_radius(sigma);
    vec2 sum = vec2(0.0);
    for (int k = max(-radius, -y); k <= min(radius, int(g.nodes_y) - 1 - y); ++k)
        sum += exp(-0.5 * float(k * k) / (sigma * sigma)) * rows[int(first + n) + k * int(g.nodes_x)];
    means[first + n] = sum.y > 0.0 ? sum.x / sum.y : 0.0;
}
