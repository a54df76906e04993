// Local means to shares of the cones, at the nodes, in place. Include after the model's math, with PARAMS defined as its struct.
#include "perception/local_mean_grid.h"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Push {
    PARAMS params;
    float black_cd_m2;
    uint nodes;             // of one view
} push;

#include "perception/mesopic/rod_vision_share.glsl"

layout(scalar, binding = 1) buffer Nodes { float nodes[]; };

void main() {
    const uint n = gl_GlobalInvocationID.x, view = gl_GlobalInvocationID.z;
    if (n >= push.nodes) return;
    nodes[view * push.nodes + n] = share_to_simulate(view, nodes[view * push.nodes + n]);
}
