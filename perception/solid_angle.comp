#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Solid angle of each pixel of the eye image, sr; 0 where the lens shows nothing. Run once for a geometry.

#include "shaders/geometry.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(scalar, binding = 0) readonly buffer Geometry { EyeGeometry geometry[]; };
layout(scalar, binding = 1) writeonly buffer SolidAngle { float solid_angle[]; };

void main() {
    const uint view = gl_GlobalInvocationID.z;
    const EyeGeometry g = geometry[view];
    const uvec2 at = gl_GlobalInvocationID.xy;
    if (at.x >= g.width || at.y >= g.height) return;
    const vec2 px = vec2(at) + 0.5;
    solid_angle[(view * g.height + at.y) * g.width + at.x] = geometry_visible(g, px) ? geometry_solid_angle(g, px) : 0.0;
}
