#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// A picture from the CPU becomes the eye image, cleaned.

#include "shaders/tile_statistics.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(scalar, binding = 0) readonly buffer Picture { vec3 picture[]; };
layout(scalar, binding = 1) readonly buffer SolidAngle { float solid_angle[]; };
layout(scalar, binding = 2) writeonly buffer Scene { vec4 scene[]; };

layout(scalar, push_constant) uniform Push { uint width, height; } push;

void main() {
    const uvec2 at = gl_GlobalInvocationID.xy;
    if (at.x >= push.width || at.y >= push.height) return;
    const uint index = (gl_GlobalInvocationID.z * push.height + at.y) * push.width + at.x;
    bool changed;
    const vec3 cleaned = clean_scene_colour(picture[index], changed);
    scene[index] = scene_pixel(cleaned, solid_angle[index] > 0.0, changed);
}
