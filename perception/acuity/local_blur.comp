#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// One axis of the blur, from the picture into the plane (rows) or from the plane back into the picture (columns). Linear light; what is
// not visible does not count. The width follows a mean over degrees, so it is the same, nearly, over a kernel, and two passes do.

#include "perception/acuity/local_blur_lists.glsl"
#include "perception/acuity/local_blur_math.glsl"
#include "perception/local_mean_math.glsl"
#define LIST_BINDING 1
#include "perception/acuity/tile_of_list.glsl"

layout(local_size_x = tile_width, local_size_y = tile_height) in;
layout(constant_id = 0) const uint columns = 0u;   // 0: rows

layout(scalar, binding = 0) readonly buffer From { vec4 from[]; };
layout(scalar, binding = 2) readonly buffer Nodes { float nodes[]; };
layout(scalar, binding = 3) buffer To { vec4 to[]; };

layout(scalar, push_constant) uniform Push {
    LocalMeanGrid grid;
    uint tiles_x, tiles_y, all_tiles;
} push;

// Light with its weight in w. The picture holds light and visibility; the plane holds sums.
vec4 weighted(vec4 v) { return columns == 1u ? v : vec4(v.rgb, 1.0) * (v.w > 0.0 ? 1.0 : 0.0); }

// Sum of the kernel times light and of the kernel, from the outermost pixels inwards.
vec4 kernel_sum(int centre, int stride, int before, int after, float variance) {
    const int radius = blur_radius(variance);
    vec4 sum = vec4(0.0);
    float weight = 1.0, outer = 0.0, total = 0.0;
    for (int n = radius; n >= 1; --n) {
        vec4 pair = vec4(0.0);
        if (n <= before) pair = weighted(from[centre - n * stride]);
        if (n <= after) pair += weighted(from[centre + n * stride]);
        sum += weight * pair;
        total += 2.0 * weight;
        const float inner = inner_weight(weight, outer, n, variance);
        outer = weight;
        weight = inner;
    }
    return (sum + weight * weighted(from[centre])) / (total + weight);
}

void main() {
    Tile tile;
    const LocalMeanGrid g = push.grid;
    const bool there = tile_of_list(columns == 1u ? list_columns : list_rows, push.all_tiles, push.tiles_x, push.tiles_y, tile);
    const uvec2 at = uvec2(tile.x * tile_width, tile.y * tile_height) + gl_LocalInvocationID.xy;
    if (!there || at.x >= g.width || at.y >= g.height) return;
    const uint index = (tile.view * g.height + at.y) * g.width + at.x;
    const NodePlace place = node_place(g, vec2(at) + 0.5);
    const float variance = ENTOPTIC_AT_NODES(nodes, g, tile.view, place);
    if (columns == 0u) {
        to[index] = variance > 0.0 ? kernel_sum(int(index), 1, int(at.x), int(g.width - 1u - at.x), variance) : weighted(from[index]);
        return;
    }
    const vec4 pixel = to[index];
    if (!(variance > 0.0) || !(pixel.w > 0.0)) return;
    const vec4 sum = kernel_sum(int(index), int(g.width), int(at.y), int(g.height - 1u - at.y), variance);
    to[index] = vec4(sum.rgb / sum.w, pixel.w);
}
