#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// After each model: whether it changed the foveated picture. What no model changed need not be brought back.

#include "perception/foveation/foveation_gpu.h"
#include "perception/gate.h"

layout(local_size_x = 1) in;

layout(scalar, binding = 0) readonly buffer Model { Gate model; };
layout(scalar, binding = 1) buffer Outcome { FoveationGate outcome; };

layout(scalar, push_constant) uniform Push {
    uint first;             // 1: the first model of the frame
    uvec3 groups;           // that bring the picture back
} push;

void main() {
    // A model that has no gate never sets a counter: it always runs.
    const bool ran = model.ran != 0u || model.frames_run + model.frames_gated == 0u;
    const uint changed = ran ? 1u : push.first == 1u ? 0u : outcome.changed;
    outcome.changed = changed;
    outcome.x = push.groups.x * changed;
    outcome.y = push.groups.y;
    outcome.z = push.groups.z;
}
