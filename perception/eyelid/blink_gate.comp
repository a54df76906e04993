#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Left out, exactly, when no eye has its lid before the pupil. Which is known beforehand; here for the report.

#include "perception/gate.glsl"

layout(local_size_x = 1) in;

layout(scalar, binding = 1) buffer GateBuffer { Gate gate; };

layout(scalar, push_constant) uniform Push {
    float least_passed;
    uint groups;
} push;

void main() { ENTOPTIC_SET_EXACT_GATE(gate, push.least_passed < 1.0, push.groups, push.least_passed); }
