#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Texels of the glare grid to nodes by splines, blended between patches where they overlap.
//   coverage   writes the share of each node's light that the far field moves away (into its key)
//   veil       writes what arrives and what leaves: sign, gain and gaze window are taken in here
layout(local_size_x = 256) in;
#include "perception/glare/glare_gpu.h"
#include "perception/glare/glare_math.glsl"
#include "shaders/geometry.glsl"

layout(constant_id = 0) const uint veil = 1;

layout(scalar, binding = 0) readonly buffer Grid { float grid[]; };                // real and imaginary parts
layout(scalar, binding = 1) readonly buffer Taps { NodeTap taps[]; };          // node, tap
layout(scalar, binding = 2) buffer Coverage { vec3 coverage[]; };              // key, view, node
layout(scalar, binding = 3) buffer Exchange { vec3 exchange[]; };    // view, node: arrives, leaves
layout(scalar, binding = 4) readonly buffer Geometry { EyeGeometry geometry[]; };

layout(scalar, push_constant) uniform PushBlock { GatherPush push; };

float texel(uint plane, uint part, uint x, uint y) { return grid[2 * (plane * glare_plane + y * glare_row + x) + part]; }

vec3 sampled(NodeTap tap) {
    const uint x = uint(tap.u + 0.5), y = uint(tap.v + 0.5), part = tap.patch_index & 1;
    const vec3 across = spline_weights(tap.u - float(x)), down = spline_weights(tap.v - float(y));
    vec3 colour;
    for (uint c = 0; c < 3; ++c) {
        const uint plane = (tap.patch_index >> 1) * 3 + c;
        vec3 rows;
        for (uint j = 0; j < 3; ++j)
            rows[j] = dot(across, vec3(texel(plane, part, x - 1, y + j - 1), texel(plane, part, x, y + j - 1), texel(plane, part, x + 1, y + j - 1)));
        colour[c] = dot(down, rows);
    }
    return colour;
}

void main() {
    const uint view = gl_WorkGroupID.z, i = gl_GlobalInvocationID.x, per_view = push.nodes_x * push.nodes_y;
    if (i >= per_view) return;
    const uint node = view * per_view + i;
    vec3 sum = vec3(0.0);
    for (uint t = 0; t < push.taps; ++t) {
        const NodeTap tap = taps[node * push.taps + t];
        if (tap.weight > 0.0) sum += tap.weight * sampled(tap);
    }
    const uint all = per_view * gl_NumWorkGroups.z;
    if (veil == 0) {
        coverage[push.key * all + node] = sum;
        return;
    }
    // Light is never negative; a sharpened kernel is, a little, beside a streak.
    if (push.positive != 0) sum = max(sum, vec3(0.0));
    vec3 leaves = vec3(0.0);
    if (push.leaves != 0) leaves = mix(coverage[push.first_key * all + node], coverage[push.second_key * all + node], push.blend) + (1.0 - push.gain);
    const vec2 px = (vec2(i % push.nodes_x, i / push.nodes_x) - 1.0) * float(push.step) + 0.5;
    float window = push.sign;
    if (push.window_sigma > 0.0) window *= gaze_window(push.gaze[min(view, 1u)], geometry_direction(geometry[view], px), push.window_sigma);
    const vec3 arrived = push.add != 0 ? exchange[2 * node] : vec3(0.0), left = push.add != 0 ? exchange[2 * node + 1] : vec3(0.0);
    exchange[2 * node] = arrived + window * sum;
    exchange[2 * node + 1] = left + window * leaves;
}
