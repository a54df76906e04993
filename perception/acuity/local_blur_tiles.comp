#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The largest variance (px²) that a pixel of each tile can have: that of the nodes around it. One invocation a tile.

#include "perception/acuity/tile_lists.glsl"
#include "perception/local_mean_math.glsl"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Nodes { float nodes[]; };
layout(scalar, binding = 1) readonly buffer Statistics { TileStatistics statistics[]; };
layout(scalar, binding = 2) writeonly buffer Widest { float widest[]; };

layout(scalar, push_constant) uniform Push {
    LocalMeanGrid grid;
    uint tiles_x, tiles_y, views;
} push;

void main() {
    const LocalMeanGrid g = push.grid;
    const uint entry = gl_GlobalInvocationID.x;
    if (entry >= push.tiles_x * push.tiles_y * push.views) return;
    const Tile tile = tile_at(entry, push.tiles_x, push.tiles_y);
    const vec2 top_left = vec2(tile.x * tile_width, tile.y * tile_height) + 0.5;
    const NodePlace first = node_place(g, top_left), last = node_place(g, top_left + vec2(tile_width - 1u, tile_height - 1u));
    float largest = 0.0;
    for (uint y = first.y0; y <= last.y1; ++y)
        for (uint x = first.x0; x <= last.x1; ++x) largest = max(largest, nodes[(tile.view * g.nodes_y + y) * g.nodes_x + x]);
    widest[entry] = statistics[entry].visible > 0u ? largest : 0.0;
}
