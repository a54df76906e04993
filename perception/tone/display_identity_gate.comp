#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The pass over the picture is left out when it would write every pixel as it is: exposure 1, nothing above white. Exact.

#include "perception/gate.h"
#include "perception/observer_state.h"
#include "shaders/scene_statistics.h"

layout(local_size_x = 1) in;

layout(scalar, binding = 0) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 1) readonly buffer Statistics { SceneStatistics statistics[]; };
layout(scalar, binding = 2) buffer GateBlock { Gate gate; };

layout(scalar, push_constant) uniform Push {
    uint views, groups;
    float white_cd_m2;
} push;

void main() {
    bool needed = false;
    float most = 0.0;
    for (uint v = 0u; v < push.views; ++v) {
        const bool as_it_is = state[v].tone.exposure == 1.0 && state[v].shoulder == 0.0 && statistics[v].max_channel <= push.white_cd_m2;
        most = max(most, max(abs(log(state[v].tone.exposure)), statistics[v].max_channel / push.white_cd_m2 - 1.0));
        needed = needed || !as_it_is;
    }
    gate.dispatch[0].x = needed ? push.groups : 0u;
    gate.dispatch[0].y = 1u;
    gate.dispatch[0].z = needed ? push.views : 0u;
    gate.ran = needed ? 1u : 0u;
    gate.reason = needed ? 0u : 1u;
    gate.bound = 0.0;
    gate.value = most;
    if (needed) gate.frames_run += 1u;
    else gate.frames_gated += 1u;
}
