#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Empties the tiles of the scene image that the lens hides: models work in place and may have left light there.
#include "shaders/eye_geometry.h"
#include "shaders/scene_statistics.h"

layout(local_size_x = 32, local_size_y = 8) in;

layout(scalar, binding = 0) uniform Geometry { EyeGeometry geometry[2]; };
layout(scalar, binding = 1) readonly buffer Tiles { uint tile_list[]; };
layout(scalar, binding = 2) writeonly buffer Scene { vec4 scene[]; };

layout(scalar, push_constant) uniform Push {
    uint view;
    uint tiles;
} push;

void main() {
    const uint index = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (index >= push.tiles) return;
    const uvec2 tile = uvec2(tile_list[index] & 0xffffu, tile_list[index] >> 16);
    const uvec2 pixel = tile * uvec2(tile_width, tile_height) + gl_LocalInvocationID.xy;
    const uvec2 size = uvec2(geometry[push.view].width, geometry[push.view].height);
    if (pixel.x < size.x && pixel.y < size.y) scene[(push.view * size.y + pixel.y) * size.x + pixel.x] = vec4(0.0, 0.0, 0.0, pixel_hidden);
}
