#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The near field at full resolution, for tiles on the list: what the light above the threshold does to the pixels around it, from its profile,
// without the texture that the far field may have. One workgroup a tile; the kernel is made for the tile's own pixels per degree.
// Of the excess over the panel's white, a pixel that is white in every channel gets nothing: the panel shows it as it is.
#include "perception/glare/glare_gpu.h"
#include "perception/glare/glare_math.glsl"
#include "perception/observer_state.h"
#include "shaders/geometry.glsl"
#include "shaders/scene_statistics.h"

layout(local_size_x = 32, local_size_y = 8) in;
const uint max_side = 2 * max_near_px + 1;
const uint reach_width = tile_width + 2 * max_near_px, reach_height = tile_height + 2 * max_near_px;

layout(scalar, binding = 0) readonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 2) readonly buffer NearTiles { uint near_count; uint near_list[]; };
layout(scalar, binding = 3) readonly buffer Geometry { EyeGeometry geometry[]; };
layout(scalar, binding = 4) readonly buffer Profile { RadialEntry profile[]; };
layout(scalar, binding = 5) buffer NearLight { vec3 near_light[]; };

layout(scalar, push_constant) uniform PushBlock { NearPush push; };

#include "perception/glare/glare_radial.glsl"

shared vec3 weights[max_side * max_side];
shared vec3 light[reach_width * reach_height];      // excess of the pixels in reach of the tile; red < 0: not there, or not to be seen
shared uint lit_rows;      // a bit for each row of pixels, from max_near_px above the tile to as many below, that holds light above the threshold
shared int lit_left, lit_right;      // and where, in columns from the tile's first

vec3 kernel(float theta) {
    return radial_kernel(theta, push.profile, push.weights) * near_share(theta, push.near);
}

// Integral of the kernel over the pixel at (dx, dy), sr; across and down are the steps of one pixel in direction. A kernel that falls with the third
// power of the distance d, in pixels, is off by 9 / (24 d^2 samples^2): 0.6 % at most, but for the pixels next to the source.
vec3 pixel_weight(ivec2 d, vec3 across, vec3 down, float solid_angle) {
    const int distance = max(abs(d.x), abs(d.y)), samples = distance <= 1 ? 8 : distance <= 2 ? 4 : distance <= 4 ? 3 : 2;
    vec3 sum = vec3(0.0);
    for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) {
            const vec2 at = vec2(d) + (vec2(i, j) + 0.5) / float(samples) - 0.5;
            sum += kernel(length(at.x * across + at.y * down));
        }
    return sum * (solid_angle / float(samples * samples));
}

// Column of the picture, or -1 outside. A sphere closes.
int column_of(int x, bool sphere) {
    if (sphere) return (x + int(push.width)) % int(push.width);
    return x < int(push.width) ? max(x, -1) : -1;
}

vec3 excess(vec4 pixel, float threshold) {
    const vec3 above = max(pixel.rgb - threshold, vec3(0.0));
    return push.turn == 0 ? above : push.turn == 1 ? above.gbr : above.brg;
}

void main() {
    const uint lane = gl_LocalInvocationIndex, per_view = push.tiles_x * push.tiles_y;
    for (uint slot = gl_WorkGroupID.x; slot < near_count; slot += gl_NumWorkGroups.x) {
        const uint tile = near_list[slot], view = tile / per_view;
        const uvec2 corner = uvec2(tile % per_view % push.tiles_x, tile % per_view / push.tiles_x) * uvec2(tile_width, tile_height);
        const EyeGeometry g = geometry[view];
        const vec2 middle = min(vec2(corner) + vec2(tile_width, tile_height) * 0.5, vec2(push.width, push.height) - 0.5);
        const vec3 across = (geometry_direction(g, middle + vec2(2, 0)) - geometry_direction(g, middle - vec2(2, 0))) * 0.25;
        const vec3 down = (geometry_direction(g, middle + vec2(0, 2)) - geometry_direction(g, middle - vec2(0, 2))) * 0.25;
        const float solid_angle = length(cross(across, down));
        const int radius = int(clamp(ceil(push.near / max(min(length(across), length(down)), 1e-6)), 1.0, float(max_near_px)));
        const int side = 2 * radius + 1;
        const uint base = view * push.width * push.height;
        const float threshold = push.near_from < 0.0 ? state[view].tone.scene_white_cd_m2 : push.near_from * state[view].adaptation_cd_m2;
        const bool sphere = g.kind == geometry_equirect;
        // Where is light at all? A lamp fills few of the rows in reach.
        barrier();
        if (lane == 0) {
            lit_rows = 0u;
            lit_left = int(tile_width + max_near_px);
            lit_right = -int(max_near_px) - 1;
        }
        barrier();
        const uint reach_x = tile_width + 2 * uint(radius), reach_y = tile_height + 2 * uint(radius);
        for (uint i = lane; i < reach_x * reach_y; i += tile_width * tile_height) {
            const int row = int(i / reach_x) - radius, column = int(i % reach_x) - radius;
            const int y = int(corner.y) + row, x = column_of(int(corner.x) + column, sphere);
            const uint place = (i / reach_x) * reach_width + i % reach_x;
            light[place] = vec3(-1.0);
            if (x < 0 || y < 0 || y >= int(push.height)) continue;
            const vec4 pixel = scene[base + uint(y) * push.width + uint(x)];
            if (pixel.w > 0.0) light[place] = excess(pixel, threshold);
            if (max(pixel.r, max(pixel.g, pixel.b)) <= threshold) continue;
            atomicOr(lit_rows, 1u << uint(row + int(max_near_px)));
            atomicMin(lit_left, column);
            atomicMax(lit_right, column);
        }
        barrier();
        const uint lit = lit_rows;
        const uvec2 px = corner + gl_LocalInvocationID.xy;
        const bool inside = px.x < push.width && px.y < push.height;
        const uint at = base + px.y * push.width + px.x;
        if (lit == 0u) {
            if (inside && push.add == 0) near_light[at] = vec3(0.0);
            continue;
        }
        // The kernel is the same on both sides.
        const uint last_weight = uint(side * side) - 1;
        for (uint i = lane; i <= last_weight / 2; i += tile_width * tile_height) {
            const ivec2 d = ivec2(int(i) % side, int(i) / side) - radius;
            weights[i] = weights[last_weight - i] = d == ivec2(0) ? vec3(0.0) : pixel_weight(d, across, down, solid_angle);
        }
        barrier();
        if (!inside) continue;
        const vec4 here = scene[at];
        const vec3 own = push.leaves != 0 ? excess(here, threshold) : vec3(0.0);
        const int column = int(gl_LocalInvocationID.x);
        const bool loses = own != vec3(0.0), white = push.near_from < 0.0 && min(here.r, min(here.g, here.b)) >= threshold;
        const int first = loses ? -radius : max(-radius, lit_left - int(tile_width) + 1), last = loses ? radius : min(radius, lit_right);
        vec3 sum = vec3(0.0);
        const ivec2 local = ivec2(gl_LocalInvocationID.xy);
        for (int dy = -radius; dy <= radius && !white; ++dy) {
            // Rows without light matter only to pixels that have some to lose.
            const bool row_lit = (lit >> uint(local.y + dy + int(max_near_px)) & 1u) != 0u;
            if (!row_lit && !loses) continue;
            const int row = (local.y + dy + radius) * int(reach_width) + local.x + radius, weight = (dy + radius) * side + radius;
            for (int dx = first; dx <= last; ++dx) {
                const vec3 there = light[row + dx];
                if (there.r >= 0.0) sum += weights[weight + dx] * (there - own);
            }
        }
        sum *= gaze_window(push.gaze[min(view, 1u)], geometry_direction(g, middle), push.window_sigma);
        if (here.w <= 0.0) sum = vec3(0.0);
        near_light[at] = push.add != 0 ? near_light[at] + sum : sum;
    }
}
