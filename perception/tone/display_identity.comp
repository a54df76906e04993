#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/observer_state.h"
#include "perception/tone/display_identity_math.glsl"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer State { ObserverState state[]; };

layout(scalar, push_constant) uniform Push {
    DisplayIdentityParams params;
    uint pixels;            // of one view
    float white_cd_m2;
} push;

void main() {
    const uint i = gl_GlobalInvocationID.x, view = gl_GlobalInvocationID.z;
    if (i >= push.pixels) return;
    const uint at = view * push.pixels + i;
    const vec4 pixel = scene[at];
    const float e = state[view].tone.exposure, y = luminance(pixel.rgb);
    const float t = displayed(push.params, y, e, state[view].shoulder, push.white_cd_m2);
    // A pixel that the panel shows as it is keeps its bits.
    if (t == y && max(pixel.r, max(pixel.g, pixel.b)) <= push.white_cd_m2) return;
    scene[at] = vec4(displayed_colour(pixel.rgb, y, t, push.white_cd_m2), pixel.w);
}
