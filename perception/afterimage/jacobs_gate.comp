#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Whether what the retina holds can be seen in this frame, and whether it is at rest.

#include "perception/afterimage/jacobs_gpu.h"
#include "perception/afterimage/jacobs_math.glsl"
#include "perception/gate.glsl"

layout(local_size_x = 1) in;

layout(scalar, binding = 0) buffer Status { RetinaStatus status; };
layout(scalar, binding = 1) buffer GateBuffer { Gate gate; };

layout(scalar, push_constant) uniform Push {
    uint tiles_x, tiles_y;
    uint snap;
    float dt_s;
} push;

const float half_a_code = 0.5;

void main() {
    const float codes =
        bound_codes(uintBitsToFloat(status.added_bits), uintBitsToFloat(status.common_bits), uintBitsToFloat(status.spread_bits));
    const GateDecision d = gate_decision(codes, half_a_code, gate.ran == 1u, gate.quiet_s, gate.fade, push.dt_s, push.snap == 1u);
    gate.dispatch[dispatch_mark] = GateDispatch(d.run ? (push.tiles_x * push.tiles_y + 63u) / 64u : 0u, 1u, 1u);
    gate.dispatch[dispatch_apply] = GateDispatch(d.run ? push.tiles_x : 0u, push.tiles_y, 1u);
    gate.ran = d.run ? 1u : 0u;
    gate.reason = d.run ? 0u : 1u;
    gate.bound = d.run ? 0.0 : codes;
    gate.value = codes;
    gate.quiet_s = d.quiet_s;
    gate.fade = d.fade;
    if (d.run) gate.frames_run += 1u;
    else gate.frames_gated += 1u;
    status.rested = 1u - status.awake;
}
