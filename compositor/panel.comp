#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Panel: light to codes.
#include "compositor/panel.glsl"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) readonly buffer Light { vec3 panel_light[]; };
layout(scalar, binding = 1) writeonly buffer Codes { uint codes[]; };

layout(scalar, push_constant) uniform Push {
    uint pixels;          // of both eyes
    PanelCurve curve;
} push;

void main() {
    const uint at = gl_WorkGroupID.y * gl_NumWorkGroups.x * gl_WorkGroupSize.x + gl_GlobalInvocationID.x;
    if (at < push.pixels) codes[at] = panel_codes(push.curve, panel_light[at], at);
}
