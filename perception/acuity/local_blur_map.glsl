// Local means to the variance of the blur (px²), at the nodes, in place. Include after the model's math, which gives
// added_variance(Params, BothEyes, BlurPlace) in arcmin², with PARAMS defined as its struct.
#include "perception/acuity/local_blur_math.glsl"
#include "perception/local_mean_grid.h"
#include "perception/observer_state.h"
#include "perception/residual.glsl"
#include "perception/tone_curve.glsl"
#include "shaders/geometry.glsl"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 1) buffer Nodes { float nodes[]; };
layout(scalar, binding = 2) readonly buffer Cells { LocalCell cells[]; };
layout(scalar, binding = 3) readonly buffer Geometry { EyeGeometry geometry[]; };

layout(scalar, push_constant) uniform Push {
    LocalMeanGrid grid;
    vec3 gaze;
    float black_cd_m2, tick_part;
    uint view, tick, seed;
    PARAMS params;          // last: C++ leaves room for the longest
} push;

void main() {
    const LocalMeanGrid g = push.grid;
    const uint n = gl_GlobalInvocationID.x;
    if (n >= g.nodes_x * g.nodes_y) return;
    const uint at = push.view * g.nodes_x * g.nodes_y + n;
    const float scene = max(nodes[at], 1e-6), ppd = cells[at].ppd;
    const BothEyes eyes = above_black(scene, ENTOPTIC_DISPLAYED_LUMINANCE(state[push.view].tone, scene), push.black_cd_m2);
    const vec3 direction = geometry_direction(geometry[push.view], (vec2(n % g.nodes_x, n / g.nodes_x) + 0.5) * float(g.cell));
    const float noise =
        push.params.randomness > 0.0 ? patch_noise(push.seed, lattice_place(direction, push.gaze, push.params.cell_deg), push.tick, push.tick_part) : 0.0;
    const float eccentricity_deg = 57.29577951308232 * acos(clamp(dot(direction, push.gaze), -1.0, 1.0));
    const float arcmin2 = added_variance(push.params, eyes, BlurPlace(noise, eccentricity_deg, ppd));
    const bool seen = cells[at].sr > 0.0 || nodes[at] > 0.0;   // else far behind the rim of the lens
    nodes[at] = seen ? min(arcmin2 * ppd * ppd / 3600.0, max_variance_px2) : 0.0;
}
