#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Structure factor of the open pupil: mean over the patches that lie in it. Patches stand at fixed places of the eye; a growing pupil takes
// them in smoothly, and each counts for the ring of pupil that it stands for, hence its radius as weight.
#include "perception/glare/luidolt_spectral_gpu.h"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) readonly buffer Structure { float structure[]; };
layout(scalar, binding = 1) readonly buffer Radii { float radii_mm[]; };
layout(scalar, binding = 2) writeonly buffer Sum { float total[]; };

layout(scalar, push_constant) uniform PushBlock { StructurePush push; };

void main() {
    const uint i = gl_GlobalInvocationID.x;
    float sum = 0.0, weights = 0.0;
    for (uint pair = 0; pair < push.pairs; ++pair) {
        const float w = radii_mm[pair] * smoothstep(-pupil_edge_mm, pupil_edge_mm, push.pupil_radius_mm - radii_mm[pair]);
        if (w <= 0.0) continue;
        weights += w;
        sum += w * structure[pair * structure_n * structure_n + i];
    }
    total[i] = weights > 0.0 ? sum / weights : 1.0;
}
