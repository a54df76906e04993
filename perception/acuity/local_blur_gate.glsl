// Gate of the blurs by local means: left out when no luminance that the picture can have asks for a blur. Include after the model's math,
// which gives needs_blur(Params, BothEyes, ppd), with PARAMS defined as its struct.
#include "perception/gate.h"
#include "perception/observer_state.h"
#include "perception/residual.glsl"
#include "perception/tone_curve.glsl"
#include "shaders/scene_statistics.h"

layout(local_size_x = 1) in;

layout(scalar, binding = 0) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 1) readonly buffer Statistics { SceneStatistics statistics[]; };
layout(scalar, binding = 2) buffer GateBuffer { Gate gate; };

layout(scalar, push_constant) uniform Push {
    float black_cd_m2, largest_ppd;
    uint node_groups, tile_groups, views;
    PARAMS params;          // last: C++ leaves room for the longest
} push;

bool needed_at(uint view, float y) {
    return needs_blur(push.params, above_black(y, ENTOPTIC_DISPLAYED_LUMINANCE(state[view].tone, y), push.black_cd_m2), push.largest_ppd);
}

// Statistics are of the picture before glare, which may take a little light from a pixel: half is allowed for.
bool needed_in(uint view) {
    const float lowest = max(0.5 * statistics[view].min_y, min_scene_cd_m2);
    bool needed = needed_at(view, lowest);
    for (uint i = 0u; i < tone_points && !needed; ++i)
        if (tone_luminance(i) > lowest) needed = needed_at(view, tone_luminance(i));
    return needed;
}

void main() {
    bool runs = false;
    float darkest = 3e38;
    for (uint view = 0u; view < push.views; ++view) {
        runs = runs || needed_in(view);
        darkest = min(darkest, statistics[view].min_y);
    }
    gate.dispatch[0] = GateDispatch(runs ? push.node_groups : 0u, 1u, push.views);   // local means
    gate.dispatch[1] = GateDispatch(runs ? push.node_groups : 0u, 1u, 1u);           // their variances, a view at a time
    gate.dispatch[2] = GateDispatch(runs ? push.tile_groups : 0u, 1u, 1u);           // the widest blur of each tile
    gate.dispatch[3] = GateDispatch(runs ? 1u : 0u, 1u, 1u);                         // lists of tiles
    gate.dispatch[4] = gate.dispatch[5] = GateDispatch(0u, 1u, 1u);                  // rows, columns: local_blur_plan.comp sets them
    gate.ran = 0u;
    gate.reason = 1u;
    gate.bound = 0.0;
    gate.value = darkest;
    if (!runs) gate.frames_gated += 1u;
}
