#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Glance: statistics of the tiles of one eye from 16 points a tile, for frames whose light is known to be within the panel's range: nothing is simulated
// then, but the eye goes on adapting. One invocation a tile.
#include "compositor/layers.glsl"

layout(local_size_x = 64) in;

layout(scalar, binding = 3) writeonly buffer Statistics { TileStatistics tiles[]; };
layout(scalar, binding = 4) readonly buffer SolidAngles { float solid_angle[]; };     // sr, 0 where the lens shows nothing
layout(scalar, binding = 21) writeonly buffer Scene { vec4 scene[]; };                // written at those points only

layout(scalar, push_constant) uniform Push {
    uint view;
    uint tiles;               // of one eye
} push;

void main() {
    const uint t = gl_GlobalInvocationID.x, view = push.view;
    if (t >= push.tiles) return;
    const uvec2 size = uvec2(geometry[view].width, geometry[view].height);
    const uint across = (size.x + tile_width - 1u) / tile_width;
    const uvec2 corner = uvec2(t % across * tile_width, t / across * tile_height);
    const uvec2 extent = min(uvec2(tile_width, tile_height), size - corner);
    TileStatistics tile = TileStatistics(0.0, 0.0, 3e38, 0.0, 0.0, 0u, 0u);
    for (uint i = 0u; i < glance_columns * glance_rows; ++i) {
        const uvec2 pixel = corner + glance_point(extent, i);
        const uint at = (view * size.y + pixel.y) * size.x + pixel.x;
        const float sr = solid_angle[at] * float(extent.x * extent.y) / float(glance_columns * glance_rows);
        if (!(sr > 0.0)) continue;
        bool changed = false;
        const vec3 light = compose_layers(view, 1, vec2(pixel) + 0.5, lens_coordinates(view, 1, vec2(pixel) + 0.5), changed);
        scene[at] = scene_pixel(light, true, false);
        const float y = luminance(light);
        tile.sum_y_sr += y * sr;
        tile.sum_sr += sr;
        tile.min_y = min(tile.min_y, y);
        tile.max_y = max(tile.max_y, y);
        tile.max_channel = max(tile.max_channel, max(light.r, max(light.g, light.b)));
        tile.visible += extent.x * extent.y / (glance_columns * glance_rows);
    }
    tile.visible = tile.sum_sr > 0.0 ? max(tile.visible, 1u) : 0u;
    tiles[view * push.tiles + t] = tile;
}
