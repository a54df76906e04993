#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// One workgroup: which tiles a blurred pixel's light can reach, from how far, and the group counts; all zero when no disc is wide enough.
// The order within the list varies and does not matter: tiles do not depend on each other.

#include "perception/dof/dof_gpu.h"
#include "perception/dof/dof_list.glsl"
#include "perception/dof/dof_math.glsl"
#include "perception/gate.h"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) readonly buffer Radii { float tile_radius_px[]; };
layout(scalar, binding = 1) writeonly buffer Lists { uint lists[]; };
layout(scalar, binding = 2) writeonly buffer Reach { float reach_px[]; };
layout(scalar, binding = 3) buffer GateBuffer { Gate gate; };

layout(scalar, push_constant) uniform Push {
    uint tiles_x, tiles_y, views;
    uint wraps;             // 1: the picture's left and right edges meet
    uint depth_known;       // 0: nobody knows a depth in this frame
} push;

// A disc of half a pixel's diameter cannot be seen; in fact the kernel is the identity up to twice that.
const float invisible_disc_px = 0.5;

shared float widest[256];
shared uint count;

// Largest radius of the tiles whose discs reach into this one, px.
float reach_of(uint t) {
    const int across = int(push.tiles_x), down = int(push.tiles_y);
    const int view = int(t) / (across * down), ty = int(t) / across % down, tx = int(t) % across;
    float reach = 0.0;
    for (int dy = -4; dy <= 4; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const int y = ty + dy;
            int x = tx + dx;
            if (push.wraps == 1u) x = (x + across) % across;
            if (x < 0 || y < 0 || x >= across || y >= down) continue;
            // From the last row of one tile to the first of the other. Neighbours across may touch.
            const float gap = float(max((abs(dy) - 1) * int(tile_height) + 1, abs(dx)));
            const float radius = tile_radius_px[(view * down + y) * across + x];
            if (radius > identity_radius_px && radius + 0.5 > gap) reach = max(reach, radius);
        }
    return reach;
}

void main() {
    const uint i = gl_LocalInvocationID.x;
    const uint all = push.tiles_x * push.tiles_y * push.views;
    if (i == 0u) count = 0u;
    float wide = 0.0;
    for (uint t = i; push.depth_known == 1u && t < all; t += 256u) wide = max(wide, tile_radius_px[t]);
    widest[i] = wide;
    for (uint stride = 128u; stride > 0u; stride /= 2u) {
        barrier();
        if (i < stride) widest[i] = max(widest[i], widest[i + stride]);
    }
    barrier();
    const float disc_px = 2.0 * widest[0];
    const bool runs = disc_px > invisible_disc_px;
    for (uint t = i; runs && t < all; t += 256u) {
        const float reach = reach_of(t);
        if (reach <= identity_radius_px) continue;
        lists[1u + atomicAdd(count, 1u)] = t;
        reach_px[t] = reach;
    }
    barrier();
    if (i != 0u) return;
    lists[0] = count;
    const GateDispatch listed = GateDispatch(min(count, dof_list_row), (count + dof_list_row - 1u) / dof_list_row, 1u);
    gate.dispatch[dof_dispatch_pixels] = count > 0u ? GateDispatch(push.tiles_x, push.tiles_y, push.views) : GateDispatch(0u, 0u, 0u);
    gate.dispatch[dof_dispatch_tiles] = listed;
    gate.ran = runs ? 1u : 0u;
    gate.reason = runs ? 0u : (push.depth_known == 1u ? 1u : 2u);
    gate.bound = 0.0;
    gate.value = disc_px;
    if (runs) gate.frames_run += 1u;
    else gate.frames_gated += 1u;
}
