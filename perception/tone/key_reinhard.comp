#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/observer_state.h"
#include "perception/tone/key_reinhard_math.glsl"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer State { ObserverState state[]; };

layout(scalar, push_constant) uniform Push {
    KeyReinhardParams params;
    uint pixels;            // of one view
    float white_cd_m2, black_cd_m2;
} push;

void main() {
    const uint i = gl_GlobalInvocationID.x, view = gl_GlobalInvocationID.z;
    if (i >= push.pixels) return;
    const uint at = view * push.pixels + i;
    const vec4 pixel = scene[at];
    const float y = luminance(pixel.rgb);
    const float r = response(push.params, y, state[view].adaptation_cd_m2);
    const vec3 light = push.black_cd_m2 + (push.white_cd_m2 - push.black_cd_m2) * scaled_colour(pixel.rgb, y, r);
    scene[at] = vec4(min(light, vec3(push.white_cd_m2)), pixel.w);     // white times a rounded 1 may be a digit too much
}
