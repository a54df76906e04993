#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Directions and solid angles of the foveated image's texels. Run once.

#include "perception/foveation/foveation_gpu.h"
#include "shaders/geometry.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(scalar, binding = 0) readonly buffer Geometry { EyeGeometry geometry[]; };
layout(scalar, binding = 1) writeonly buffer Texels { FoveatedTexel texels[]; };

void main() {
    const EyeGeometry g = geometry[0];
    const uvec2 at = gl_GlobalInvocationID.xy;
    if (at.x >= g.width || at.y >= g.height) return;
    const vec2 px = vec2(at) + 0.5;
    texels[at.y * g.width + at.x] = FoveatedTexel(geometry_direction(g, px), geometry_visible(g, px) ? geometry_solid_angle(g, px) : 0.0);
}
