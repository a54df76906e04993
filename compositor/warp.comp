#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Warp: layers to the scene image of one eye. One workgroup a tile that the lens shows.
#include "compositor/layers.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(scalar, binding = 3) writeonly buffer Scene { vec4 scene[]; };

layout(scalar, push_constant) uniform Push {
    uint view;
    uint tiles;               // entries of tile_list
} push;

void main() {
    const uint index = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (index >= push.tiles) return;
    const uvec2 tile = uvec2(tile_list[index] & 0xffffu, tile_list[index] >> 16);
    const uvec2 pixel = tile * uvec2(tile_width, tile_height) + gl_LocalInvocationID.xy;
    const uvec2 size = uvec2(geometry[push.view].width, geometry[push.view].height);
    const vec2 px = vec2(pixel) + 0.5;
    if (pixel.x >= size.x || pixel.y >= size.y) return;
    bool changed = false, changed_now;
    const vec3 light = compose_layers(push.view, 1, px, lens_coordinates(push.view, 1, px), changed);
    const vec3 clean = clean_scene_colour(light, changed_now);
    const bool visible = lens_visible(geometry[push.view], px);
    scene[(push.view * size.y + pixel.y) * size.x + pixel.x] = scene_pixel(clean, visible, changed || changed_now);
}
