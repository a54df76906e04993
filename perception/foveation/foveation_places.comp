#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Where in the view each texel lies in this frame, in pixels; far outside where it lies nowhere.

#include "perception/foveation/foveation_gpu.h"
#include "shaders/geometry.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(scalar, binding = 0) readonly buffer Geometry { EyeGeometry geometry[]; };     // of the views
layout(scalar, binding = 1) readonly buffer Views { FoveatedView gaze_axes[]; };
layout(scalar, binding = 2) readonly buffer Texels { FoveatedTexel texels[]; };
layout(scalar, binding = 3) writeonly buffer Places { vec2 places[]; };

layout(scalar, push_constant) uniform PushBlock { FoveationPush push; };

void main() {
    const uvec2 at = gl_GlobalInvocationID.xy;
    const uint view = gl_GlobalInvocationID.z;
    if (at.x >= push.side || at.y >= push.side) return;
    const uint texel = at.y * push.side + at.x;
    const FoveatedView axes = gaze_axes[view];
    const vec3 d = texels[texel].direction;
    const bool in_disc = texels[texel].sr > 0.0;
    places[view * push.side * push.side + texel] =
        in_disc ? geometry_pixel(geometry[view], d.x * axes.right + d.y * axes.up + d.z * axes.back) : vec2(-1e6);
}
