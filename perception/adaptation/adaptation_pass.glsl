// The pass of every adaptation model. One workgroup: the tiles of one view to its target, and the state one step on. Sums in a fixed
// order: same frame, same bits. The model's .comp includes this and gives: AdaptationParams (a macro), gaze_of(params),
// settled(target): the state after a long time, and stepped(state, target): the state push.dt_s later.
#include "perception/adaptation/gaze_luminance.glsl"
#include "perception/observer_state.h"
#include "shaders/colour_math.glsl"

float settled(float target);
float stepped(float state, float target);

layout(local_size_x = 256) in;

layout(scalar, binding = 0) readonly buffer Tiles { TileStatistics tiles[]; };
layout(scalar, binding = 1) readonly buffer Geometry { EyeGeometry geometry[]; };
layout(scalar, binding = 2) buffer Statistics { SceneStatistics statistics[]; };
layout(scalar, binding = 3) buffer State { ObserverState state[]; };
layout(scalar, binding = 4) readonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 5) readonly buffer SolidAngle { float solid_angle[]; };

layout(scalar, push_constant) uniform Push {
    AdaptationParams params;
    vec3 gaze;              // as gaze_in_view() gives it
    float dt_s;             // finite, >= 0
    uint view, tiles_x, tiles_y;
    uint snap;              // 1: the state becomes the target
    uint lid_closed;        // 1: the state holds
    uint veil;              // 1: the straylight of the whole field counts
    uint by_pixel;          // 1: a small picture, whose tiles are wider than the Gaussian: each pixel counts by itself
} push;

shared GazeSums parts[256];
shared float clip_cd_m2;

// One pixel, as a tile of its own.
GazeSums pixel_sums(EyeGeometry g, uint p, bool gaze_known) {
    const uint at = push.view * g.width * g.height + p;
    const float sr = solid_angle[at], y = luminance(scene[at].rgb);
    const TileStatistics pixel = TileStatistics(y * sr, sr, y, y, y, 0u, sr > 0.0 ? 1u : 0u);
    const vec2 px = vec2(p % g.width, p / g.width) + 0.5;
    const float scatter = push.veil == 1u ? straylight(gaze_known ? angle_between(geometry_direction(g, px), push.gaze) : 3.14159) : 0.0;
    return tile_sums(pixel, gaze_known ? pixel_weight(gaze_of(push.params), g, push.gaze, px) : 0.0, scatter, clip_cd_m2);
}

void main() {
    const uint i = gl_LocalInvocationID.x;
    const EyeGeometry g = geometry[push.view];
    if (i == 0u) clip_cd_m2 = clip_luminance(gaze_of(push.params), statistics[push.view]);
    barrier();
    const uint tile_count = push.tiles_x * push.tiles_y;
    const bool gaze_known = dot(push.gaze, push.gaze) > 0.5;
    GazeSums sum = no_tiles();
    for (uint p = i; push.by_pixel == 1u && p < g.width * g.height; p += 256u) sum = added(sum, pixel_sums(g, p, gaze_known));
    for (uint t = i; push.by_pixel == 0u && t < tile_count; t += 256u) {
        const uint x = t % push.tiles_x, y = t / push.tiles_x;
        const float weight = gaze_known ? tile_weight(gaze_of(push.params), g, push.gaze, x, y) : 0.0;
        const float scatter = push.veil == 1u ? straylight(tile_angle(g, push.gaze, x, y)) : 0.0;
        sum = added(sum, tile_sums(tiles[push.view * tile_count + t], weight, scatter, clip_cd_m2));
    }
    parts[i] = sum;
    for (uint stride = 128u; stride > 0u; stride /= 2u) {
        barrier();
        if (i < stride) parts[i] = added(parts[i], parts[i + stride]);
    }
    barrier();
    if (i != 0u) return;
    const float target = gaze_luminance(gaze_of(push.params), parts[0], float(g.width) * float(g.height));
    ObserverState s = state[push.view];
    statistics[push.view].gaze_y = target;
    s.target_cd_m2 = target;
    if (push.snap == 1u || s.initialised == 0u) s.adaptation_cd_m2 = settled(target);
    else if (push.lid_closed == 0u) s.adaptation_cd_m2 = stepped(s.adaptation_cd_m2, target);
    s.initialised = 1u;
    state[push.view] = s;
}
