#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Sums of each cell's pixels; one invocation a cell, pixels in order, so the same picture gives the same bits.

#include "perception/local_mean_grid.h"
#include "shaders/colour_math.glsl"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer SolidAngle { float solid_angle[]; };
layout(scalar, binding = 2) writeonly buffer Cells { LocalCell cells[]; };

layout(scalar, push_constant) uniform Push { LocalMeanGrid grid; } push;

void main() {
    const LocalMeanGrid g = push.grid;
    const uint n = gl_GlobalInvocationID.x, view = gl_GlobalInvocationID.z;
    if (n >= g.nodes_x * g.nodes_y) return;
    const uint left = n % g.nodes_x * g.cell, top = n / g.nodes_x * g.cell;
    const uint right = min(left + g.cell, g.width), bottom = min(top + g.cell, g.height);
    float y_sr = 0.0, sum_sr = 0.0, visible = 0.0;
    for (uint y = top; y < bottom; ++y)
        for (uint x = left; x < right; ++x) {
            const uint at = (view * g.height + y) * g.width + x;
            const float sr = solid_angle[at];
            y_sr += luminance(scene[at].rgb) * sr;
            sum_sr += sr;
            visible += sr > 0.0 ? 1.0 : 0.0;
        }
    const float ppd = visible > 0.0 ? 0.017453292519943295 * sqrt(visible / sum_sr) : g.ppd;
    cells[view * g.nodes_x * g.nodes_y + n] = LocalCell(y_sr, sum_sr, ppd);
}
