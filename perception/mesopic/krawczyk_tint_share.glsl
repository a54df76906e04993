// Rods' share by a place's displayed luminance. Include after declaring `push` with `params` and `black_cd_m2`.
#include "perception/mesopic/krawczyk_tint_math.glsl"

layout(scalar, binding = 0) readonly buffer State { ObserverState state[]; };

// The tone curve backwards: scene luminance of a displayed one, cd/m². Curves never fall; where one is flat the darkest scene counts.
float scene_luminance(uint view, float displayed) {
    const float straight = state[view].tone.straight_until_cd_m2 * state[view].tone.exposure;
    if (displayed <= straight) return displayed / state[view].tone.exposure;
    const float wanted = log(max(displayed, 1e-12)) * 0.4342944819032518;
    uint low = 0u, high = tone_points - 1u;
    while (high - low > 1u) {
        const uint middle = (low + high) / 2u;
        if (state[view].tone.log10_displayed[middle] < wanted) low = middle;
        else high = middle;
    }
    const float below = state[view].tone.log10_displayed[low], above = state[view].tone.log10_displayed[high];
    const float part = clamp((wanted - below) / max(above - below, 1e-9), 0.0, 1.0);
    return exp(2.302585092994046 * ((float(low) + part) / float(tone_points_per_decade) - 6.0));
}

float share_to_simulate(float scene, float displayed) {
    return rod_share(push.params, above_black(max(scene, 1e-9), max(displayed, 1e-20), push.black_cd_m2));
}
