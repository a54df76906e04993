#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Decides whether this frame's glare can be seen, and sets the group counts of all later passes. One workgroup.
//
// Bound. A pixel changes by at most F d in each channel, F the share of light that leaves a pixel and d the largest difference of two
// pixels of one channel. With M the largest channel and m the least luminance of a view, no channel is below M - (M - m)/0.0722, since
// blue has the least weight in luminance; so d <= min(M, (M - m)/0.0722). A tone map Y -> r(Y) with r(Y)/Y = g falling, g <= 1/Y, moves a
// channel by at most g (|dc| + |dY|) <= 2 F d / m of full range, and sRGB is never steeper than 12.92 * 255 codes.
// Of the light above the panel's white nothing is scattered when there is none: exact.
#include "perception/glare/glare_gpu.h"
#include "perception/observer_state.h"
#include "shaders/scene_statistics.h"

layout(local_size_x = 1) in;

layout(scalar, binding = 0) readonly buffer Statistics { SceneStatistics statistics[]; };
layout(scalar, binding = 1) buffer GateBlock { Gate gate; };
layout(scalar, binding = 2) buffer NearTiles { uint near_count; };
layout(scalar, binding = 3) readonly buffer State { ObserverState state[]; };

layout(scalar, push_constant) uniform PushBlock { GatePush push; };

void main() {
    float change = 0.0, brightest = 0.0;
    bool excess = false;
    for (uint view = 0; view < push.views; ++view) {
        const float top = statistics[view].max_channel, low = statistics[view].min_y;
        brightest = max(brightest, top);
        excess = excess || (push.excess != 0 && top > state[view].tone.scene_white_cd_m2);
        const float difference = min(top, max(top - low, 0.0) / 0.0722);
        if (difference > 0.0) change = max(change, low > 0.0 ? min(push.scattered * difference / low * 2.0 * 12.92 * 255.0, 255.0) : 255.0);
    }
    if (push.always != 0) change = 255.0;
    const bool runs = brightest > 0.0 && (excess || change > 0.5);
    for (uint i = 0; i < gate_entries; ++i) {
        gate.dispatch[i].x = runs ? push.groups[i].x : 0u;
        gate.dispatch[i].y = push.groups[i].y;
        gate.dispatch[i].z = push.groups[i].z;
    }
    gate.dispatch[gate_billboard_choice] = GateDispatch(runs ? 1u : 0u, 1u, 1u);
    gate.dispatch[gate_billboards] = GateDispatch(0u, 1u, 1u);
    gate.ran = runs ? 1u : 0u;
    gate.reason = runs ? gate_reason_runs : brightest <= 0.0 ? gate_reason_dark : push.excess != 0 ? gate_reason_within_panel : gate_reason_uniform;
    gate.bound = runs ? 0.0 : change;
    gate.value = excess ? brightest : change;
    if (runs) ++gate.frames_run; else ++gate.frames_gated;
    near_count = 0u;
}
