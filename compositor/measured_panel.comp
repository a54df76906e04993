#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Panel, where a display was measured: light to the codes that send it.
#include "compositor/measured_panel_gpu.h"
#include "compositor/panel.glsl"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) readonly buffer Panels { MeasuredPanelTable panels[2]; };
layout(scalar, binding = 1) readonly buffer Light { vec3 panel_light[]; };
layout(scalar, binding = 2) writeonly buffer Codes { uint codes[]; };

layout(scalar, push_constant) uniform Push {
    uint pixels;          // of both eyes
    PanelCurve curve;     // its dither and frame
} push;

#include "compositor/measured_panel.glsl"

void main() {
    const uint at = gl_WorkGroupID.y * gl_NumWorkGroups.x * gl_WorkGroupSize.x + gl_GlobalInvocationID.x;
    if (at < push.pixels) codes[at] = dithered(measured_codes(at / (push.pixels / 2), panel_light[at]), push.curve, at);
}
