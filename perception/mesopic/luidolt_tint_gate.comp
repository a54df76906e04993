#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Sets the tint's group counts: zero when no displayed code of any view can change by more than half.

#include "perception/gate.h"
#include "perception/mesopic/luidolt_tint_math.glsl"
#include "perception/observer_state.h"

layout(local_size_x = 1) in;

layout(scalar, binding = 0) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 1) buffer GateBuffer { Gate gate; };

layout(scalar, push_constant) uniform Push {
    LuidoltTintParams params;
    uint groups, views;
} push;

void main() {
    float darkest = state[0].adaptation_cd_m2;
    for (uint view = 1u; view < push.views; ++view) darkest = min(darkest, state[view].adaptation_cd_m2);
    const float bound = bound_codes(push.params, rod_share(push.params, darkest));
    const bool runs = bound > 0.5;
    gate.dispatch[0] = GateDispatch(runs ? push.groups : 0u, 1u, push.views);
    gate.ran = runs ? 1u : 0u;
    gate.reason = runs ? 0u : 1u;
    gate.bound = bound;
    gate.value = darkest;
    if (runs) gate.frames_run += 1u;
    else gate.frames_gated += 1u;
}
