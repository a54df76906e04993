#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Sets the tint's group counts: zero when no displayed code of any view can change by more than half.

#include "perception/gate.h"
#include "perception/mesopic/krawczyk_tint_params.h"
#include "shaders/scene_statistics.h"

layout(local_size_x = 1) in;

layout(scalar, push_constant) uniform Push {
    KrawczykTintParams params;
    uint groups, views;
    float black_cd_m2;
} push;

#include "perception/mesopic/krawczyk_tint_share.glsl"

layout(scalar, binding = 1) readonly buffer Statistics { SceneStatistics statistics[]; };
layout(scalar, binding = 2) buffer GateBuffer { Gate gate; };

// Largest share of a view: of its darkest pixel, half of that in case models before `tone` took light from it, or of any brighter entry of the
// tone curve.
float largest_share(uint view) {
    const float lowest = max(0.5 * statistics[view].min_y, min_scene_cd_m2);
    float largest = share_to_simulate(lowest, ENTOPTIC_DISPLAYED_LUMINANCE(state[view].tone, lowest));
    for (uint i = 0u; i < tone_points; ++i) {
        const float y = tone_luminance(i);
        if (y > lowest) largest = max(largest, share_to_simulate(y, ENTOPTIC_DISPLAYED_LUMINANCE(state[view].tone, y)));
    }
    return largest;
}

void main() {
    float share = 0.0;
    for (uint view = 0u; view < push.views; ++view) share = max(share, largest_share(view));
    const float bound = bound_codes(push.params, share);
    const bool runs = bound > 0.5;
    gate.dispatch[0] = GateDispatch(runs ? push.groups : 0u, 1u, push.views);
    gate.ran = runs ? 1u : 0u;
    gate.reason = runs ? 0u : 1u;
    gate.bound = bound;
    gate.value = share;
    if (runs) gate.frames_run += 1u;
    else gate.frames_gated += 1u;
}
