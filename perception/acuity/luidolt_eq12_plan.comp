#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// One workgroup: lists the tiles to work on and sets the group counts; all zero when no pixel of any view can be dark enough.
// The order within a list varies and does not matter: tiles do not depend on each other.

#include "perception/acuity/luidolt_eq12_tiles.glsl"
#include "perception/gate.h"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) readonly buffer Statistics { SceneStatistics statistics[]; };
layout(scalar, binding = 1) readonly buffer Tiles { TileStatistics tiles[]; };
layout(scalar, binding = 2) readonly buffer Inside { uint inside[]; };
layout(scalar, binding = 3) writeonly buffer Lists { uint lists[]; };
layout(scalar, binding = 4) buffer GateBuffer { Gate gate; };

layout(scalar, push_constant) uniform Push {
    uint tiles_x, tiles_y, views;
    int reach_x, reach_y;      // in tiles: how far the widest kernel reaches
    uint split;                // 1: dark tiles with their surroundings inside the picture go to their own list
    float dark_cd_m2;          // a tile with a pixel below it is worked on
} push;

shared uint counts[list_count];

void append(uint list, uint tile, uint all) { lists[list * all + atomicAdd(counts[list], 1u)] = tile; }

void place(uint entry, uint all) {
    const Tile tile = tile_at(entry, push.tiles_x, push.tiles_y);
    const ivec2 count = ivec2(push.tiles_x, push.tiles_y), at = ivec2(tile.x, tile.y), reach = ivec2(push.reach_x, push.reach_y);
    const ivec2 first = max(at - reach, ivec2(0)), last = min(at + reach, count - 1);
    float darkest = 3e38;
    for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x)
            darkest = min(darkest, tiles[(tile.view * push.tiles_y + uint(y)) * push.tiles_x + uint(x)].min_y);
    if (darkest >= push.dark_cd_m2) return;
    append(list_lightness, entry, all);
    if (tiles[entry].min_y >= push.dark_cd_m2) return;
    append(push.split == 1u && inside[entry] == 1u ? list_interior : list_rim, entry, all);
}

void main() {
    const uint i = gl_LocalInvocationID.x;
    if (i < list_count) counts[i] = 0u;
    barrier();
    float darkest = statistics[0].min_y;
    for (uint view = 1u; view < push.views; ++view) darkest = min(darkest, statistics[view].min_y);
    const uint all = push.tiles_x * push.tiles_y * push.views;
    const uint looked_at = darkest < push.dark_cd_m2 ? all : 0u;
    for (uint t = i; t < looked_at; t += 256u) place(t, all);
    barrier();
    if (i != 0u) return;
    for (uint list = 0u; list < list_count; ++list) {
        const uint n = counts[list];
        gate.dispatch[list] = GateDispatch(min(n, list_row), (n + list_row - 1u) / list_row, 1u);
    }
    const bool runs = counts[list_interior] + counts[list_rim] > 0u;
    gate.ran = runs ? 1u : 0u;
    gate.reason = runs ? 0u : 1u;
    gate.bound = 0.0;
    gate.value = darkest;
    if (runs) gate.frames_run += 1u;
    else gate.frames_gated += 1u;
    // How long each list is, for the last row of workgroups.
    for (uint list = 0u; list < list_count; ++list) lists[list_count * all + list] = counts[list];
}
