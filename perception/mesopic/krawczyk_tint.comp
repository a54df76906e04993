#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/mesopic/krawczyk_tint_params.h"

layout(local_size_x = 256) in;

layout(scalar, push_constant) uniform Push {
    KrawczykTintParams params;
    uint pixels;            // of one view
    float white_cd_m2, black_cd_m2;
} push;

#include "perception/mesopic/krawczyk_tint_share.glsl"

layout(scalar, binding = 1) buffer Scene { vec4 scene[]; };

void main() {
    const uint i = gl_GlobalInvocationID.x, view = gl_GlobalInvocationID.z;
    if (i >= push.pixels) return;
    const uint at = view * push.pixels + i;
    const vec4 pixel = scene[at];
    const float displayed = luminance(pixel.rgb);
    const float share = share_to_simulate(scene_luminance(view, displayed), displayed);
    if (share <= 0.0) return;
    const vec3 seen = push.black_cd_m2 + tinted(pixel.rgb - push.black_cd_m2, tint(push.params), share);
    scene[at] = vec4(clamp(seen, vec3(push.black_cd_m2), vec3(push.white_cd_m2)), pixel.w);
}
