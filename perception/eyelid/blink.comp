#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The lid's share for each pixel of one view.

#include "shaders/shared_types.h"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) buffer Scene { vec4 scene[]; };

layout(scalar, push_constant) uniform Push {
    vec3 passed;
    uint view, pixels;
} push;

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= push.pixels) return;
    const uint at = push.view * push.pixels + i;
    scene[at] = vec4(scene[at].rgb * push.passed, scene[at].w);
}
