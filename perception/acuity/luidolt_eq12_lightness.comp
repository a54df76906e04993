#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Lightness of every pixel that a blurred pixel may see, from the untouched picture (trap L18).

#define LIST_BINDING 1
#include "perception/acuity/luidolt_eq12_tiles.glsl"
#include "perception/acuity/tile_of_list.glsl"

layout(local_size_x = tile_width, local_size_y = tile_height) in;

layout(scalar, binding = 0) readonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 2) writeonly buffer Plane { float plane[]; };

layout(scalar, push_constant) uniform Push { uint width, height, tiles_x, tiles_y, all_tiles; } push;

void main() {
    Tile tile;
    const bool there = tile_of_list(list_lightness, push.all_tiles, push.tiles_x, push.tiles_y, tile);
    const uvec2 at = uvec2(tile.x * tile_width, tile.y * tile_height) + gl_LocalInvocationID.xy;
    if (!there || at.x >= push.width || at.y >= push.height) return;
    const vec4 pixel = scene[(tile.view * push.height + at.y) * push.width + at.x];
    plane[plane_index(push.width, push.height, tile.view, at)] = pixel.w > 0.0 ? lightness(luminance(pixel.rgb)) : -1.0;
}
