// How a gate decides: at once to run, slowly to stop, so that a scene near the bound does not make a model flicker.
#ifndef ENTOPTIC_PERCEPTION_GATE_GLSL
#define ENTOPTIC_PERCEPTION_GATE_GLSL

#include "perception/gate.h"

ENTOPTIC_MATH_BEGIN(perception)

struct GateDecision {
    bool run;
    float quiet_s, fade;
};

// `value` is what the model compares with `limit` (at or under it, leaving the model out cannot be seen). A model that ran goes on until
// the value has been under half its limit for gate_linger_s. dt_s: since the frame before; `snap`: no memory, no fade.
// A model whose bound is exact ignores `fade`; others scale what they add by it.
FN GateDecision gate_decision(float value, float limit, bool ran_before, float quiet_s, float fade, float dt_s, bool snap) {
    GateDecision d;
    bool needed = !(value <= limit);
    bool nearly = !(value <= 0.5f * limit) || needed;
    d.quiet_s = nearly || snap ? 0.0f : quiet_s + max(dt_s, 0.0f);
    d.run = needed || (ran_before && !snap && d.quiet_s < gate_linger_s && value > 0.0f);
    float step = max(dt_s, 0.0f) / gate_fade_s;
    d.fade = snap ? (d.run ? 1.0f : 0.0f) : (needed ? min(fade + step, 1.0f) : max(fade - (nearly ? 0.0f : step), 0.0f));
    return d;
}

ENTOPTIC_MATH_END

// For a gate whose bound is exact: writes its outcome, and the workgroups of dispatch 0.
#define ENTOPTIC_SET_EXACT_GATE(gate, runs, groups, compared) \
    gate.dispatch[0] = GateDispatch((runs) ? (groups) : 0u, 1u, 1u); \
    gate.ran = (runs) ? 1u : 0u; \
    gate.reason = (runs) ? 0u : 1u; \
    gate.bound = 0.0; \
    gate.value = compared; \
    if (runs) gate.frames_run += 1u; \
    else gate.frames_gated += 1u

#endif
