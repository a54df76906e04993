// The plan pass of tone maps without a straight part: one workgroup a view writes ObserverState::tone. The model's shader includes this and
// gives `push.white_cd_m2` and displayed_luminance(view, y) in cd/m².
#include "perception/observer_state.h"
#include "perception/tone_curve.glsl"

layout(local_size_x = 128) in;

layout(scalar, binding = 0) buffer State { ObserverState state[]; };

float displayed_luminance(uint view, float y);

void main() {
    const uint i = gl_LocalInvocationID.x, view = gl_WorkGroupID.x;
    if (i < tone_points) state[view].tone.log10_displayed[i] = log(max(displayed_luminance(view, tone_luminance(i)), 1e-9)) * 0.4342944819;
    if (i != 0u) return;
    const float adaptation = max(state[view].adaptation_cd_m2, 1e-6);
    const float exposure = displayed_luminance(view, adaptation) / adaptation;
    state[view].tone.exposure = exposure;
    state[view].tone.straight_until_cd_m2 = 0.0;
    state[view].tone.scene_white_cd_m2 = push.white_cd_m2 / exposure;
}
