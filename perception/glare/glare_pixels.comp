#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Eye image to the node lattice: the light that every pixel has to scatter, luminance times solid angle, is shared out between its nine nodes by splines
// (the adjoint of what the pass "apply" does). A workgroup does 256 columns of pixels and 8 rows of nodes: sums along the columns first,
// then across. A pixel belongs to the segment of its nearest node and counts for that node and both its neighbours.
#include "perception/glare/glare_gpu.h"
#include "perception/glare/glare_math.glsl"
#include "perception/observer_state.h"

layout(local_size_x = 256) in;
const uint node_rows = 8;
layout(constant_id = 0) const uint step = 4;
layout(constant_id = 1) const uint source = source_scene;

layout(scalar, binding = 0) readonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer SolidAngles { float solid_angle[]; };     // sr, 0 where the lens shows nothing
layout(scalar, binding = 2) writeonly buffer Nodes { vec3 nodes[]; };
layout(scalar, binding = 3) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 4) readonly buffer Drawn { vec3 drawn[]; };

layout(scalar, push_constant) uniform PushBlock { LatticePush push; };

shared vec3 columns[node_rows][256];

vec3 light_of(uint at, float white) {
    if (source == source_drawn) return drawn[at];
    const vec3 light = scene[at].rgb;
    return source == source_excess ? max(light - white, vec3(0.0)) : source == source_displayed ? min(light, vec3(white)) : light;
}

void main() {
    const uint lane = gl_LocalInvocationID.x, view = gl_WorkGroupID.z;
    const uint nodes_a_group = 256 / step - 2;
    const uint first_node = gl_WorkGroupID.x * nodes_a_group, first_row = gl_WorkGroupID.y * node_rows;
    // Node n stands on pixel step (n - 1); its segment begins half a step before. Lane 0: the segment before that of the first node.
    const int x = (int(first_node) - 2) * int(step) - int(step / 2) + int(lane);
    const bool inside = x >= 0 && x < int(push.width);
    const uint base = view * push.width * push.height + uint(clamp(x, 0, int(push.width) - 1));
    const float white = state[view].tone.scene_white_cd_m2;
    vec3 before = vec3(0.0), here = vec3(0.0);
    for (uint segment = 0; segment < node_rows + 2; ++segment) {
        vec3 after = vec3(0.0);
        const int start = (int(first_row + segment) - 2) * int(step) - int(step / 2);
        for (uint k = 0; k < step; ++k) {
            // Read without branches; what lies outside counts nothing.
            const int y = start + int(k), row = clamp(y, 0, int(push.height) - 1);
            const uint at = base + uint(row) * push.width;
            const vec3 light = light_of(at, white) * (inside && y == row ? solid_angle[at] : 0.0);
            const vec3 w = spline_weights((float(k) - float(step / 2)) / float(step));
            before += w.x * light;
            here += w.y * light;
            after += w.z * light;
        }
        if (segment > 1) columns[segment - 2][lane] = before;
        before = here;
        here = after;
    }
    barrier();
    for (uint i = lane; i < nodes_a_group * node_rows; i += 256) {
        const uint row = i / nodes_a_group, node = i % nodes_a_group;
        vec3 sum = vec3(0.0);
        for (uint k = 0; k < step; ++k) {
            const vec3 w = spline_weights((float(k) - float(step / 2)) / float(step));
            const uint at = node * step + k;
            sum += w.z * columns[row][at] + w.y * columns[row][at + step] + w.x * columns[row][at + 2 * step];
        }
        if (first_node + node < push.nodes_x && first_row + row < push.nodes_y)
            nodes[(view * push.nodes_y + first_row + row) * push.nodes_x + first_node + node] =
                push.turn == 0 ? sum : push.turn == 1 ? sum.gbr : sum.brg;
    }
}
