#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// What the pass "pixels" makes of an image that is 1 where the geometry shows anything: the coverage of each node. Once per geometry.
#include "perception/glare/glare_gpu.h"
#include "perception/glare/glare_math.glsl"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer SolidAngles { float solid_angle[]; };     // sr, 0 where the lens shows nothing
layout(scalar, binding = 1) writeonly buffer Nodes { float nodes[]; };

layout(scalar, push_constant) uniform PushBlock { LatticePush push; };

void main() {
    const uint view = gl_WorkGroupID.z, i = gl_GlobalInvocationID.x;
    if (i >= push.nodes_x * push.nodes_y) return;
    const ivec2 centre = (ivec2(i % push.nodes_x, i / push.nodes_x) - 1) * int(push.step);
    const int reach = int(push.step) * 3 / 2;
    float sum = 0.0;
    for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
            const ivec2 at = centre + ivec2(dx, dy);
            if (at.x < 0 || at.y < 0 || at.x >= int(push.width) || at.y >= int(push.height)) continue;
            sum += solid_angle[(view * push.height + uint(at.y)) * push.width + uint(at.x)] * spline(float(dx) / float(push.step)) *
                   spline(float(dy) / float(push.step));
        }
    nodes[view * push.nodes_x * push.nodes_y + i] = sum;
}
