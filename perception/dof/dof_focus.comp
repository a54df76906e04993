#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// One workgroup: where the eyes are focused. The median distance within half a degree of each eye's gaze, the mean of both eyes, followed
// in dioptres; or the vergence or the fixed distance that the recorder gives.

#include "perception/dof/dof_gpu.h"
#include "perception/dof/dof_math.glsl"
#include "shaders/geometry.glsl"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Dioptre { float dioptre[]; };
layout(scalar, binding = 1) readonly buffer SolidAngle { float solid_angle[]; };
layout(scalar, binding = 2) readonly buffer Geometry { EyeGeometry geometry[]; };
layout(scalar, binding = 3) readonly buffer Eyes { DofEye eyes[]; };
layout(scalar, binding = 4) buffer Focus { DofFocus focus; };

layout(scalar, push_constant) uniform Push {
    uint views;
    float given;            // >= 0: the target, whatever the picture shows
    float dt_s, tau_s;      // finite
    uint at_once, hold;     // no low-pass; the lids are closed
} push;

const float patch_radius_rad = 0.5 * 0.017453292519943295;

shared float samples[64];
shared float median;

// Distance at a point of a sunflower of 64 around the gaze; negative where nothing is known.
float sampled(uint view, uint i) {
    const vec3 gaze = eyes[view].gaze;
    const vec3 across = normalize(cross(gaze, abs(gaze.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0))), up = cross(across, gaze);
    const float r = patch_radius_rad * sqrt((float(i) + 0.5) / 64.0), turn = 2.399963229728653 * float(i);
    const vec2 px = geometry_pixel(geometry[view], gaze + r * (cos(turn) * across + sin(turn) * up));
    if (!(px.x >= 0.0 && px.y >= 0.0 && px.x < float(geometry[view].width) && px.y < float(geometry[view].height))) return unknown_dioptre;
    const uint at = (view * geometry[view].height + uint(px.y)) * geometry[view].width + uint(px.x);
    return solid_angle[at] > 0.0 ? dioptre[at] : unknown_dioptre;
}

// Leaves the median of the known samples in `median`.
void find_median(uint i) {
    const float own = samples[i];
    uint known = 0u, below = 0u;
    for (uint j = 0u; j < 64u; ++j) {
        known += samples[j] >= 0.0 ? 1u : 0u;
        below += samples[j] >= 0.0 && (samples[j] < own || (samples[j] == own && j < i)) ? 1u : 0u;
    }
    if (own >= 0.0 && below == (known - 1u) / 2u) median = own;
}

void main() {
    const uint i = gl_LocalInvocationID.x;
    float sum = 0.0;
    uint seeing = 0u;
    for (uint view = 0u; view < push.views && push.given < 0.0; ++view) {
        if (i == 0u) median = unknown_dioptre;
        samples[i] = sampled(view, i);
        barrier();
        find_median(i);
        barrier();
        sum += max(median, 0.0);
        seeing += median >= 0.0 ? 1u : 0u;
        barrier();
    }
    if (i != 0u) return;
    focus.target = push.given >= 0.0 ? push.given : (seeing > 0u ? sum / float(seeing) : unknown_dioptre);
    if (focus.target < 0.0) return;
    if (push.at_once == 1u || focus.dioptre < 0.0) focus.dioptre = focus.target;
    else if (push.hold == 0u) focus.dioptre = followed(focus.dioptre, focus.target, push.dt_s, push.tau_s);
}
