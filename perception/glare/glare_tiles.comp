#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Which tiles need the near field: those with light above the threshold in them or in reach of them, one tile to the side and `rows` up or down. Tiles
// with such light in them or at most two rows from them are marked as near_beside, too: what is drawn varies there within a few pixels. The order of
// the list varies from run to run; the picture does not depend on it.
#include "perception/glare/glare_gpu.h"
#include "perception/observer_state.h"
#include "shaders/scene_statistics.h"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) readonly buffer Tiles { TileStatistics tiles[]; };
layout(scalar, binding = 1) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 2) buffer GateBlock { Gate gate; };
layout(scalar, binding = 3) buffer NearTiles { uint near_count; uint near_list[]; };
layout(scalar, binding = 4) writeonly buffer Flags { uint flags[]; };

layout(scalar, push_constant) uniform PushBlock { TilesPush push; };

void main() {
    const uint tile = gl_GlobalInvocationID.x, per_view = push.tiles_x * push.tiles_y;
    if (tile >= per_view * push.views) return;
    const uint view = tile / per_view;
    const int x = int(tile % per_view % push.tiles_x), y = int(tile % per_view / push.tiles_x);
    float brightest = 0.0, beside = 0.0;
    for (int dy = -int(push.rows); dy <= int(push.rows); ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const ivec2 at = ivec2(x + dx, y + dy);
            if (at.x < 0 || at.y < 0 || at.x >= int(push.tiles_x) || at.y >= int(push.tiles_y)) continue;
            const float there = tiles[view * per_view + uint(at.y) * push.tiles_x + uint(at.x)].max_channel;
            brightest = max(brightest, there);
            if (abs(dy) <= 2) beside = max(beside, there);
        }
    const float threshold = push.near_from < 0.0 ? state[view].tone.scene_white_cd_m2 : push.near_from * state[view].adaptation_cd_m2;
    const bool near = brightest > threshold;
    flags[tile] = beside > threshold ? near_beside : near ? near_reached : near_none;
    if (!near) return;
    const uint slot = atomicAdd(near_count, 1u);
    near_list[slot] = tile;
    atomicMax(gate.dispatch[gate_near].x, min(slot + 1u, max_near_groups));
}
