// Share of the cones that a place of the picture is to be simulated with. Include after the model's math, which gives
// cone_share(Params, luminance), and after declaring `push` with `params` (photographic, strength) and `black_cd_m2`.
#include "perception/observer_state.h"
#include "perception/residual.glsl"
#include "perception/tone_curve.glsl"

layout(scalar, binding = 0) readonly buffer State { ObserverState state[]; };

// y: the local mean or the pixel's luminance, cd/m². With the residual law a place is no darker than what the eye is adapted to, so that
// shadows of a bright scene keep their colour, and only the difference to the wearer's own eye counts.
float share_to_simulate(uint view, float y) {
    float rho;
    if (push.params.photographic > 0.5) rho = cone_share(push.params, max(y, 1e-9));
    else {
        const float scene = max(max(y, state[view].adaptation_cd_m2), 1e-9);
        const BothEyes eyes = above_black(scene, ENTOPTIC_DISPLAYED_LUMINANCE(state[view].tone, scene), push.black_cd_m2);
        rho = residual_share(cone_share(push.params, eyes.scene), cone_share(push.params, eyes.panel));
    }
    return 1.0 - push.params.strength * (1.0 - rho);
}
