// Gate of the models of rod vision on scene light: left out when the cones' share is 1 at every luminance that the picture can have. Include
// after the model's math, with PARAMS defined as its struct.
#include "perception/gate.h"
#include "shaders/scene_statistics.h"

layout(local_size_x = 1) in;

layout(scalar, push_constant) uniform Push {
    PARAMS params;
    float black_cd_m2;
    uint node_groups, pixel_groups, views;
} push;

#include "perception/mesopic/rod_vision_share.glsl"

layout(scalar, binding = 1) readonly buffer Statistics { SceneStatistics statistics[]; };
layout(scalar, binding = 2) buffer GateBuffer { Gate gate; };

// Least share of a view. Statistics are of the picture before glare, which may take a little light from a pixel: half is allowed for.
float least_share(uint view) {
    const float lowest = max(0.5 * statistics[view].min_y, min_scene_cd_m2);
    float least = share_to_simulate(view, lowest);
    // Shares and the tone curve are lines between the curve's entries over log luminance, so the entries decide.
    for (uint i = 0u; i < tone_points && least >= 1.0; ++i)
        if (tone_luminance(i) > lowest) least = min(least, share_to_simulate(view, tone_luminance(i)));
    return least;
}

void main() {
    float least = 1.0;
    for (uint view = 0u; view < push.views; ++view) least = min(least, least_share(view));
    const bool runs = least < 1.0;
    gate.dispatch[0] = GateDispatch(runs ? push.node_groups : 0u, 1u, push.views);
    gate.dispatch[1] = GateDispatch(runs ? push.pixel_groups : 0u, 1u, push.views);
    gate.ran = runs ? 1u : 0u;
    gate.reason = runs ? 0u : 1u;
    gate.bound = 0.0;
    gate.value = least;
    if (runs) gate.frames_run += 1u;
    else gate.frames_gated += 1u;
}
