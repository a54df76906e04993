// Rod vision for each pixel. Include after the model's math, with PARAMS defined as its struct.
#include "perception/local_mean_math.glsl"
#include "perception/mesopic/rod_vision_math.glsl"

layout(local_size_x = 256) in;

layout(scalar, push_constant) uniform Push {
    PARAMS params;
    float black_cd_m2;
    LocalMeanGrid grid;
    RodVision rods;
} push;

#include "perception/mesopic/rod_vision_share.glsl"

layout(scalar, binding = 1) readonly buffer Nodes { float nodes[]; };
layout(scalar, binding = 2) buffer Scene { vec4 scene[]; };

void main() {
    const uint i = gl_GlobalInvocationID.x, view = gl_GlobalInvocationID.z;
    const LocalMeanGrid g = push.grid;
    if (i >= g.width * g.height) return;
    const uint at = view * g.width * g.height + i;
    float rho = 1.0;
    if (push.params.local_mean_deg > 0.0) {
        const NodePlace place = node_place(g, vec2(i % g.width, i / g.width) + 0.5);
        rho = ENTOPTIC_AT_NODES(nodes, g, view, place);
    } else rho = share_to_simulate(view, luminance(scene[at].rgb));
    if (rho >= 1.0) return;
    const vec4 pixel = scene[at];
    scene[at] = vec4(with_rods(push.rods, pixel.rgb, rho), pixel.w);
}
