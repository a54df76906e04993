// The near field at full resolution, for tiles on the list: what the light above the threshold does to the pixels around it, from the near part of
// its profile. One workgroup a tile; the kernel is made for the tile's own pixels per degree. The picture in reach passes through shared memory in
// bands as high as a tile, and bands without light are passed over. Who includes this defines the functions below and calls near_tiles().
#ifndef ENTOPTIC_PERCEPTION_GLARE_GLARE_NEAR_GLSL
#define ENTOPTIC_PERCEPTION_GLARE_GLARE_NEAR_GLSL

#include "perception/glare/glare_gpu.h"
#include "perception/glare/glare_math.glsl"
#include "perception/observer_state.h"
#include "shaders/geometry.glsl"
#include "shaders/scene_statistics.h"

layout(local_size_x = 32, local_size_y = 8) in;
const uint most_weights = ((2 * max_near_px + 1) * (2 * max_near_px + 1) + 1) / 2;
const uint reach_width = tile_width + 2 * max_near_px;

layout(scalar, binding = 1) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 2) readonly buffer NearTiles { uint near_count; uint near_list[]; };
layout(scalar, binding = 3) readonly buffer Geometry { EyeGeometry geometry[]; };
layout(scalar, binding = 4) readonly buffer Profile { RadialEntry profile[]; };

layout(scalar, push_constant) uniform PushBlock { NearPush push; };

#include "perception/glare/glare_radial.glsl"

bool tile_wanted(uint tile);
float threshold_of(uint view);                     // cd/m2; of source_at()
vec3 source_at(uint at, float threshold);          // light of a pixel that is scattered
bool visible_at(uint at);                          // pixels that the lens does not show neither send nor get light
bool wanted_at(uint at, float threshold);          // pixels that get light
void store(uint at, vec3 light);

const float absent = -1e30;

shared vec3 weights[most_weights];      // by row and column up to the middle; the kernel is the same on both sides of it
shared vec3 light[tile_height * reach_width];      // source of the pixels of a band; red `absent`: not there, or not to be seen, in tiles where a pixel has light to lose
shared uint lit_rows;      // a bit for each row of the band that holds light
shared int lit_left, lit_right;      // and where, in columns from the tile's first
shared uint losers;      // pixels of the tile that have light to lose

vec3 kernel(float theta) { return theta < push.near ? radial_kernel(theta, push.profile, push.weights) : vec3(0.0); }

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

void make_weights(int radius, vec3 across, vec3 down, float solid_angle) {
    const int side = 2 * radius + 1, middle = (side * side - 1) / 2;
    for (int i = int(gl_LocalInvocationIndex); i <= middle; i += int(tile_width * tile_height))
        weights[i] = i == middle ? vec3(0.0) : pixel_weight(ivec2(i % side, i / side) - radius, across, down, solid_angle);
}

// Rows first_row .. first_row + tile_height - 1 of the view, from `radius` columns before the tile to as many behind, and where they hold light.
void read_band(uint base, int first_row, int first_column, int radius, float threshold, bool sphere, bool losers_here) {
    const uint lane = gl_LocalInvocationIndex, reach = tile_width + 2 * uint(radius);
    if (lane == 0) {
        lit_rows = 0u;
        lit_left = int(reach_width);
        lit_right = -int(reach_width);
    }
    barrier();
    for (uint i = lane; i < tile_height * reach; i += tile_width * tile_height) {
        const int row = int(i / reach), column = int(i % reach) - radius, y = first_row + row, x = column_of(first_column + column, sphere);
        const uint place = uint(row) * reach_width + i % reach;
        const uint at = base + uint(clamp(y, 0, int(push.height) - 1)) * push.width + uint(max(x, 0));
        const bool there = x >= 0 && y >= 0 && y < int(push.height) && visible_at(at);
        const vec3 source = there ? source_at(at, threshold) : vec3(0.0);
        light[place] = there || !losers_here ? source : vec3(absent);
        if (source == vec3(0.0)) continue;
        atomicOr(lit_rows, 1u << uint(row));
        atomicMin(lit_left, column);
        atomicMax(lit_right, column);
    }
    barrier();
}

// What a band gives to the pixel of this invocation. `row`: of the band's first row, from that pixel.
vec3 from_band(int row, int radius) {
    const int column = int(gl_LocalInvocationID.x), side = 2 * radius + 1, middle = (side * side - 1) / 2;
    const int first = max(-radius, lit_left - column), last = min(radius, lit_right - column);
    vec3 sum = vec3(0.0);
    for (int k = 0; k < int(tile_height); ++k) {
        const int dy = row + k, line = dy * side, from = k * int(reach_width) + column + radius;
        if (abs(dy) > radius || (lit_rows >> uint(k) & 1u) == 0u) continue;
        for (int dx = first; dx <= last; ++dx) sum += weights[middle - abs(line + dx)] * light[from + dx];
    }
    return sum;
}

// The same of a pixel that has light to lose: to dark pixels, too, but not to those that are not there.
vec3 exchanged_with_band(int row, int radius, vec3 own) {
    const int column = int(gl_LocalInvocationID.x), side = 2 * radius + 1, middle = (side * side - 1) / 2;
    vec3 sum = vec3(0.0);
    for (int k = max(0, -radius - row); k < min(int(tile_height), radius - row + 1); ++k) {
        const int line = (row + k) * side, from = k * int(reach_width) + column + radius;
        for (int dx = -radius; dx <= radius; ++dx) {
            const vec3 there = light[from + dx];
            if (there.r > absent) sum += weights[middle - abs(line + dx)] * (there - own);
        }
    }
    return sum;
}

void near_tiles() {
    const uint lane = gl_LocalInvocationIndex, per_view = push.tiles_x * push.tiles_y;
    for (uint slot = gl_WorkGroupID.x; slot < near_count; slot += gl_NumWorkGroups.x) {
        const uint tile = near_list[slot], view = tile / per_view;
        if (!tile_wanted(tile)) continue;
        const uvec2 corner = uvec2(tile % per_view % push.tiles_x, tile % per_view / push.tiles_x) * uvec2(tile_width, tile_height);
        const EyeGeometry g = geometry[view];
        const vec2 middle = min(vec2(corner) + vec2(tile_width, tile_height) * 0.5, vec2(push.width, push.height) - 0.5);
        const vec3 across = (geometry_direction(g, middle + vec2(2, 0)) - geometry_direction(g, middle - vec2(2, 0))) * 0.25;
        const vec3 down = (geometry_direction(g, middle + vec2(0, 2)) - geometry_direction(g, middle - vec2(0, 2))) * 0.25;
        const int radius = int(clamp(ceil(push.near / max(min(length(across), length(down)), 1e-6)), 1.0, float(max_near_px)));
        const uint base = view * push.width * push.height;
        const float threshold = threshold_of(view);
        const uvec2 px = corner + gl_LocalInvocationID.xy;
        const bool inside = px.x < push.width && px.y < push.height;
        const uint at = base + min(px.y, push.height - 1) * push.width + min(px.x, push.width - 1);
        const bool wanted = inside && wanted_at(at, threshold);
        const vec3 own = wanted && push.leaves != 0 ? source_at(at, threshold) : vec3(0.0);
        barrier();
        if (lane == 0) losers = 0u;
        barrier();
        if (own != vec3(0.0)) atomicOr(losers, 1u);
        barrier();
        const bool all_bands = losers != 0u;
        const int bands = (radius + int(tile_height) - 1) / int(tile_height);
        bool have_weights = false;
        vec3 sum = vec3(0.0);
        for (int band = -bands; band <= bands; ++band) {
            const int row = band * int(tile_height);
            barrier();
            read_band(base, int(corner.y) + row, int(corner.x), radius, threshold, g.kind == geometry_equirect, all_bands);
            if (lit_rows == 0u && !all_bands) continue;
            if (!have_weights) {
                make_weights(radius, across, down, length(cross(across, down)));
                have_weights = true;
                barrier();
            }
            const int first_row = row - int(gl_LocalInvocationID.y);
            if (wanted) sum += all_bands ? exchanged_with_band(first_row, radius, own) : from_band(first_row, radius);
        }
        if (!inside) continue;
        if (have_weights) sum *= gaze_window(push.gaze[min(view, 1u)], geometry_direction(g, middle), push.window_sigma);
        store(at, sum);
    }
}

#endif
