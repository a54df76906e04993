// The pass of every adaptation model. One workgroup: the tiles of one view to its target, and the state one step on. Sums in a fixed
// order: same frame, same bits. The model's .comp includes this and gives: AdaptationParams (a macro), gaze_of(params),
// settled(target): the state after a long time, and stepped(state, target): the state push.dt_s later.
#include "perception/adaptation/gaze_luminance.glsl"
#include "perception/observer_state.h"
#include "shaders/tile_statistics.glsl"

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
    uint glanced;           // 1: of the scene only the points of glance_point() are there
} push;

shared GazeSums parts[256];
shared float clip_cd_m2;

float scatter_at(float angle) { return push.veil == 1u ? straylight(angle) : 0.0; }

// A tile's light as if it were spread evenly over it.
GazeSums whole_tile(EyeGeometry g, uint x, uint y, bool gaze_known) {
    const float weight = gaze_known ? tile_weight(gaze_of(push.params), g, push.gaze, x, y) : 0.0;
    const TileStatistics tile = tiles[(push.view * push.tiles_y + y) * push.tiles_x + x];
    return tile_sums(tile, weight, scatter_at(tile_angle(g, push.gaze, x, y)), clip_cd_m2);
}

// One pixel, as a tile of its own. `kept`: what the clipping of outliers leaves of its tile's light;
// `pixels`: for how many it stands.
GazeSums pixel_sums(EyeGeometry g, uvec2 pixel, float kept, float pixels) {
    const uint at = (push.view * g.height + pixel.y) * g.width + pixel.x;
    const float sr = pixels * solid_angle[at], y = kept * luminance(scene[at].rgb);
    const TileStatistics alone = TileStatistics(y * sr, sr, y, y, y, 0u, sr > 0.0 ? 1u : 0u);
    const float angle = angle_between(geometry_direction(g, vec2(pixel) + 0.5), push.gaze);
    return tile_sums(alone, gaussian(gaze_of(push.params), angle), scatter_at(angle), 1e30);
}

GazeSums pixels_of_tile(EyeGeometry g, uint x, uint y) {
    GazeSums sum = no_tiles();
    const TileStatistics tile = tiles[(push.view * push.tiles_y + y) * push.tiles_x + x];
    const float kept = min(1.0, clip_cd_m2 * tile.sum_sr / max(tile.sum_y_sr, 1e-30));
    const uvec2 low = uvec2(x * tile_width, y * tile_height), extent = min(uvec2(tile_width, tile_height), uvec2(g.width, g.height) - low);
    const uint pixels = extent.x * extent.y, points = push.glanced == 1u ? glance_columns * glance_rows : pixels;
    for (uint i = 0u; i < points; ++i) {
        const uvec2 point = push.glanced == 1u ? glance_point(extent, i) : uvec2(i % extent.x, i / extent.x);
        sum = added(sum, pixel_sums(g, low + point, kept, float(pixels) / float(points)));
    }
    return sum;
}

void main() {
    const uint i = gl_LocalInvocationID.x;
    const EyeGeometry g = geometry[push.view];
    if (i == 0u) clip_cd_m2 = clip_luminance(gaze_of(push.params), statistics[push.view]);
    barrier();
    const uint tile_count = push.tiles_x * push.tiles_y;
    const bool gaze_known = dot(push.gaze, push.gaze) > 0.5;
    GazeSums sum = no_tiles();
    for (uint t = i; t < tile_count; t += 256u) {
        const uint x = t % push.tiles_x, y = t / push.tiles_x;
        sum = added(sum, gaze_known && tile_is_coarse(gaze_of(push.params), g, push.gaze, x, y)
                             ? pixels_of_tile(g, x, y)
                             : whole_tile(g, x, y, gaze_known));
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
