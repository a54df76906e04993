#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/mesopic/luidolt_tint_math.glsl"
#include "perception/observer_state.h"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer State { ObserverState state[]; };

layout(scalar, push_constant) uniform Push {
    LuidoltTintParams params;
    uint pixels;            // of one view
    float white_cd_m2, black_cd_m2;
} push;

void main() {
    const uint i = gl_GlobalInvocationID.x, view = gl_GlobalInvocationID.z;
    if (i >= push.pixels) return;
    const uint at = view * push.pixels + i;
    const vec4 pixel = scene[at];
    const float range = push.white_cd_m2 - push.black_cd_m2;
    const vec3 light = (pixel.rgb - push.black_cd_m2) / range;
    const vec3 seen = tinted(light, tint(push.params), rod_share(push.params, state[view].adaptation_cd_m2));
    scene[at] = vec4(min(push.black_cd_m2 + range * seen, vec3(push.white_cd_m2)), pixel.w);
}
