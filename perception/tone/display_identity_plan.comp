#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// One workgroup a view: smooths the scene's levels, writes the curve; the workgroup of the first view decides whether the picture needs it.

#include "perception/gate.glsl"
#include "perception/observer_state.h"
#include "perception/tone/display_identity_math.glsl"
#include "perception/tone_curve.glsl"

layout(local_size_x = 128) in;

layout(scalar, binding = 0) buffer State { ObserverState state[]; };
layout(scalar, binding = 1) readonly buffer Statistics { SceneStatistics statistics[]; };

layout(scalar, push_constant) uniform Push {
    DisplayIdentityParams params;
    float white_cd_m2;
    float rate;               // 1 - exp(-dt/τ); 1: no memory
    uint within_display;      // the frame's light is known to be within the panel's range
} push;

float towards(float before, float now) { return push.rate < 1.0 ? smoothed(before, now, push.rate) : now; }

// One step of the levels, but for the shoulder, which needs the exposure.
ToneLevels step_levels(uint view) {
    const SceneStatistics s = statistics[view];
    const float white = push.white_cd_m2, before = state[view].bright_y;
    const bool inside = push.within_display != 0u;
    const float bright_now = max(inside ? min(bright_luminance(s), white) : bright_luminance(s), 1e-6);
    ToneLevels next;
    next.bright_y = before > 0.0 && push.rate < 1.0 ? before * exp(push.rate * log(bright_now / before)) : bright_now;
    next.night_weight = towards(state[view].night_weight, inside ? 0.0 : night_weight(s.dark_share));
    next.day_weight = towards(state[view].day_weight, day_weight(bright_now, white));
    next.shoulder = state[view].shoulder;
    state[view].bright_y = next.bright_y;
    state[view].night_weight = next.night_weight;
    state[view].day_weight = next.day_weight;
    return next;
}

shared float e, soft;

void main() {
    const uint i = gl_LocalInvocationID.x, view = gl_WorkGroupID.x;
    if (i == 0u) {
        e = exposure(push.params, step_levels(view), state[view].adaptation_cd_m2, push.white_cd_m2);
        const float peak = push.within_display != 0u ? 0.0 : statistics[view].max_channel;
        soft = towards(state[view].shoulder, shoulder(peak, e, push.white_cd_m2));
        state[view].shoulder = soft;
        state[view].tone.exposure = e;
        state[view].tone.straight_until_cd_m2 = (soft > 0.0 ? push.params.knee : 1.0) * push.white_cd_m2 / e;
        state[view].tone.scene_white_cd_m2 = push.white_cd_m2 / e;
    }
    barrier();
    if (i < tone_points)
        state[view].tone.log10_displayed[i] = log(displayed(push.params, tone_luminance(i), e, soft, push.white_cd_m2)) * 0.4342944819;
}
