#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Whether the retina has to be looked at. Not when all its states are 0 and this frame cannot move them: under the residual law, when
// the panel shows everything at least as bright as it is, exactly on the curve's straight part, and no channel is clipped.

#include "perception/afterimage/jacobs_gpu.h"
#include "perception/afterimage/jacobs_math.glsl"
#include "perception/gate.h"
#include "perception/observer_state.h"

layout(local_size_x = 1) in;

layout(scalar, binding = 0) readonly buffer Statistics { SceneStatistics statistics[]; };
layout(scalar, binding = 1) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 2) buffer Status { RetinaStatus status; };
layout(scalar, binding = 3) buffer GateBuffer { Gate gate; };

layout(scalar, push_constant) uniform Push {
    uint groups_x, groups_y, views;
    uint always;            // 1: photographic, or the first frame, or a jump
    float white_cd_m2;
} push;

bool shown_truthfully(uint view) {
    const float exposure = state[view].tone.exposure;
    return exposure >= 1.0 && statistics[view].max_y <= state[view].tone.straight_until_cd_m2 * rounded_up &&
           statistics[view].max_channel * exposure <= push.white_cd_m2 * rounded_up;
}

void main() {
    bool quiet = push.always == 0u && status.rested == 1u;
    for (uint view = 0u; view < push.views; ++view) quiet = quiet && shown_truthfully(view);
    gate.dispatch[dispatch_observe] = GateDispatch(quiet ? 0u : push.groups_x, push.groups_y, 1u);
    status.awake = status.added_bits = status.common_bits = status.spread_bits = 0u;
}
