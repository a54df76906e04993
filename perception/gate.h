// Gate of one model: indirect dispatches whose group counts the GPU sets to zero when leaving the model out changes no displayed code
// value by more than the stated bound. Scalar layout, one struct for C++ and GLSL.
#ifndef ENTOPTIC_PERCEPTION_GATE_H
#define ENTOPTIC_PERCEPTION_GATE_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

const uint gate_dispatches = 12;

struct GateDispatch {
    uint x, y, z;           // VkDispatchIndirectCommand
};

struct Gate {
    GateDispatch dispatch[gate_dispatches];
    uint ran;               // 1: the model ran in this frame, 0: gated
    uint reason;            // model's own number, see its ModelEntry page; 0 none
    float bound;            // largest displayed change that gating may cause, 8-bit code values
    float value;            // what was compared with the bound, in the model's own unit
    uint frames_run, frames_gated;   // counters, for the report
    float quiet_s;          // how long `value` has stayed under half its limit; gate_decision() in perception/gate.glsl
    float fade;             // 0..1, goes to `ran` within gate_fade_s: for bounds that are not exact
};

const float gate_linger_s = 0.5f;   // a model that ran goes on for this long after it could have stopped
const float gate_fade_s = 0.1f;

#ifdef __cplusplus
static_assert(sizeof(Gate) == 12 * gate_dispatches + 32, "scalar layout: the GLSL side must agree");
}  // namespace entoptic::perception
#endif

#endif
