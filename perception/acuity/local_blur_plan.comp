#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// One workgroup: lists the tiles to blur, and those above and below whose rows they need. The order within a list varies and does not
// matter: tiles do not depend on each other.

#include "perception/acuity/local_blur_math.glsl"
#include "perception/acuity/local_blur_lists.glsl"
#include "perception/gate.h"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) readonly buffer Widest { float widest[]; };
layout(scalar, binding = 1) writeonly buffer Lists { uint lists[]; };
layout(scalar, binding = 2) buffer GateBuffer { Gate gate; };

layout(scalar, push_constant) uniform Push { uint tiles_x, tiles_y, views; } push;

shared uint counts[list_count];

// Whether a kernel of a tile that is `apart` tiles above or below reaches into this one.
bool reaches(float variance, int apart) { return variance > 0.0 && blur_radius(variance) > (apart - 1) * int(tile_height); }

bool rows_needed(Tile tile) {
    const int far = (max_blur_radius + int(tile_height)) / int(tile_height);
    const int first = max(-far, -int(tile.y)), last = min(far, int(push.tiles_y) - 1 - int(tile.y));
    for (int dy = first; dy <= last; ++dy)
        if (reaches(widest[int(tile.index) + dy * int(push.tiles_x)], abs(dy))) return true;
    return false;
}

void append(uint list, uint tile, uint all) { lists[list * all + atomicAdd(counts[list], 1u)] = tile; }

void main() {
    const uint i = gl_LocalInvocationID.x, all = push.tiles_x * push.tiles_y * push.views;
    if (i < list_count) counts[i] = 0u;
    barrier();
    for (uint t = i; t < all; t += 256u) {
        if (rows_needed(tile_at(t, push.tiles_x, push.tiles_y))) append(list_rows, t, all);
        if (widest[t] > 0.0) append(list_columns, t, all);
    }
    barrier();
    if (i != 0u) return;
    const bool runs = counts[list_columns] > 0u;
    for (uint list = 0u; list < list_count; ++list) lists[list_count * all + list] = counts[list];
    for (uint list = list_rows; list <= list_columns; ++list)
        gate.dispatch[4u + list] = GateDispatch(min(counts[list], list_row), (counts[list] + list_row - 1u) / list_row, 1u);
    gate.ran = runs ? 1u : 0u;
    gate.reason = runs ? 0u : 2u;
    if (runs) gate.frames_run += 1u;
    else gate.frames_gated += 1u;
}
