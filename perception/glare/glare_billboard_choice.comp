#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Billboards or transforms, by the number of lit texels; and the list in the order of the grid, so that sums have one order.
#include "perception/glare/glare_gpu.h"

layout(local_size_x = 256) in;      // max_billboards

layout(scalar, binding = 0) buffer Lit { uint lit_count; LitTexel lit[]; };
layout(scalar, binding = 1) buffer GateBlock { Gate gate; };

layout(scalar, push_constant) uniform PushBlock { BillboardPush push; };

void main() {
    const uint i = gl_LocalInvocationIndex, count = lit_count;
    const bool few = count <= push.most;
    LitTexel mine;
    uint rank = 0;
    if (few && i < count) {
        mine = lit[i];
        for (uint k = 0; k < count; ++k) rank += lit[k].place < mine.place ? 1u : 0u;
    }
    barrier();
    memoryBarrierBuffer();
    if (few && i < count) lit[rank] = mine;
    if (i != 0) return;
    gate.dispatch[gate_rows].x = few ? 0u : push.groups[0].x;
    gate.dispatch[gate_columns].x = few ? 0u : push.groups[1].x;
    gate.dispatch[gate_billboards] = push.groups[2];
    if (!few) gate.dispatch[gate_billboards].x = 0u;
}
