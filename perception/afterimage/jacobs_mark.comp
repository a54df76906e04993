#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Which tiles of the picture lie where anything is seen: 1 where a cell under the tile is not 0.

#include "perception/afterimage/jacobs_gpu.h"
#include "perception/afterimage/jacobs_math.glsl"
#include "shaders/geometry.glsl"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Geometry { EyeGeometry geometry[]; };
layout(scalar, binding = 1) readonly buffer Seen { Afterimage seen[]; };
layout(scalar, binding = 2) writeonly buffer Flags { uint flags[]; };

layout(scalar, push_constant) uniform PushBlock { MarkPush push; };

bool is_seen(uint x, uint y) {
    const Afterimage a = seen[(push.view * push.map.size + y) * push.map.size + x];
    return dot(abs(a.gain) + abs(a.added), vec3(1.0)) > 0.0;
}

bool is_seen_within(vec2 low, vec2 high) {
    const float last = float(push.map.size - 1u);
    const uvec2 first = uvec2(clamp(low, 0.0, last)), end = uvec2(clamp(high, 0.0, last));
    for (uint y = first.y; y <= end.y; ++y)
        for (uint x = first.x; x <= end.x; ++x)
            if (is_seen(x, y)) return true;
    return false;
}

void main() {
    const uint tile = gl_GlobalInvocationID.x;
    if (tile >= push.tiles_x * push.tiles_y) return;
    const EyeGeometry g = geometry[push.view];
    vec2 low = vec2(1e9), high = vec2(-1e9);
    bool bounded = g.kind != geometry_equirect;    // on a sphere's map the corners of a tile do not bound it
    for (uint corner = 0u; corner < 4u; ++corner) {
        const vec2 px = vec2((tile % push.tiles_x + corner % 2u) * tile_width, (tile / push.tiles_x + corner / 2u) * tile_height);
        bounded = bounded && geometry_visible(g, px);
        const vec2 place = retina_of_direction(push.gaze, geometry_direction(g, px)) / push.map.cell_rad + 0.5 * float(push.map.size) - 0.5;
        low = min(low, place);
        high = max(high, place);
    }
    // On a foveated disc a tile's edges are curves: half as much again.
    const vec2 curved = g.kind == geometry_foveated ? 0.25 * (high - low) : vec2(0.0);
    // Two cells more: the neighbours between which pixels interpolate, and a tile's edge that is not quite straight on the map.
    flags[push.view * push.tiles_x * push.tiles_y + tile] = !bounded || is_seen_within(low - curved - 2.0, high + curved + 2.0) ? 1u : 0u;
}
