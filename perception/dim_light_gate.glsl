// Gate of what only rods show: exact. Left out when every eye is adapted to 0.1 cd/m² or more, or when the panel shows nothing brighter than it
// is. Include after defining PARAMS as the model's struct, whose `photographic` counts.
#include "perception/dim_light.glsl"
#include "perception/gate.glsl"

layout(local_size_x = 1) in;

layout(scalar, binding = 0) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 1) buffer GateBuffer { Gate gate; };

layout(scalar, push_constant) uniform Push {
    PARAMS params;
    uint groups, views;
} push;

void main() {
    bool runs = false;
    float darkest = state[0].adaptation_cd_m2;
    for (uint view = 0u; view < push.views; ++view) {
        bool brightens;
        ENTOPTIC_TONE_BRIGHTENS(state[view].tone, brightens);
        darkest = min(darkest, state[view].adaptation_cd_m2);
        runs = runs || (dim_share(state[view].adaptation_cd_m2) > 0.0 && (push.params.photographic > 0.5 || brightens));
    }
    runs = runs && push.groups > 0u;   // nothing of any view lies where it acts
    ENTOPTIC_SET_EXACT_GATE(gate, runs, push.groups, darkest);
}
