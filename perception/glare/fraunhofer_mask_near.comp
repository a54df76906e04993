#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The near field at full resolution, for tiles on the list: what the light above the threshold does to the pixels around it. One workgroup a
// tile; the kernel is made for the tile's own pixels per degree, zone by zone. The picture in reach passes through shared memory in
// bands as high as a tile, and bands without light are passed over.
#include "perception/glare/fraunhofer_mask_gpu.h"
#include "perception/glare/glare_gpu.h"
#include "perception/glare/glare_math.glsl"
#include "perception/observer_state.h"
#include "shaders/geometry.glsl"
#include "shaders/scene_statistics.h"

layout(local_size_x = 32, local_size_y = 8) in;
const uint most_weights = ((2 * max_near_px + 1) * (2 * max_near_px + 1) + 1) / 2;
const uint reach_width = tile_width + 2 * max_near_px;
const float absent = -1.0;

layout(scalar, binding = 0) readonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 2) readonly buffer NearTiles {
    uint near_count;
    uint near_list[];
};
layout(scalar, binding = 3) readonly buffer Geometry { EyeGeometry geometry[]; };
layout(scalar, binding = 4) readonly buffer Table { vec3 mask_table[]; };  // parity, zone, entry
layout(scalar, binding = 5) buffer NearLight { vec3 near_light[]; };

layout(scalar, push_constant) uniform PushBlock { MaskNearPush push; };

#include "perception/glare/fraunhofer_mask_lookup.glsl"

shared vec3 weights[most_weights];             // by row and column up to the middle: a mask's diffraction is the same on both sides
shared vec3 light[tile_height * reach_width];  // above the threshold, of the pixels of a band; red `absent`: not there, or not to be seen
shared uint lit_rows;                          // a bit for each row of the band that holds such light
shared int lit_left, lit_right;                // and where, in columns from the tile's first
shared uint losers;                            // of the tile's pixels, have some light to lose

// One table, or a mixture of the two between which the eye is.
vec3 kernel(vec2 offset, float width, uint zone) {
    const uint at = zone * mask_entries;
    vec3 sum = vec3(0.0);
    if (push.blend < 1.0) sum += (1.0 - push.blend) * mask_kernel(push.first_entry + at, offset, width);
    if (push.blend > 0.0) sum += push.blend * mask_kernel(push.second_entry + at, offset, width);
    return sum * (push.strength * near_share(length(offset), push.near));
}

// Of the axes that the grid's patches of a sphere have, through the middles of a cube's faces, edges and corners, the one nearest to a direction.
vec3 nearest_axis(vec3 direction) {
    vec3 nearest = vec3(0.0, 0.0, -1.0);
    for (int i = 0; i < 27; ++i) {
        const vec3 axis = vec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        if (i != 13 && dot(normalize(axis), direction) > dot(nearest, direction)) nearest = normalize(axis);
    }
    return nearest;
}

// Steps of one pixel to the side and down as offsets on the glare grid: right and down, rad.
mat2 pixel_steps(EyeGeometry g, vec3 middle, vec3 across, vec3 down) {
    const vec3 forward = g.kind == geometry_equirect ? nearest_axis(middle) : vec3(0.0, 0.0, -1.0);
    const vec3 helper = abs(forward.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, -1.0), right = normalize(cross(forward, helper));
    const vec3 up = cross(right, forward);
    return mat2(grid_offset(right, up, forward, 1.0, middle + 0.5 * across) - grid_offset(right, up, forward, 1.0, middle - 0.5 * across),
                grid_offset(right, up, forward, 1.0, middle + 0.5 * down) - grid_offset(right, up, forward, 1.0, middle - 0.5 * down));
}

// Integral of the kernel over the pixel at d, sr.
vec3 pixel_weight(ivec2 d, mat2 steps, float solid_angle, uint zone) {
    const int distance = max(abs(d.x), abs(d.y)), samples = distance <= 1 ? 16 : distance <= 2 ? 8 : 4;
    const float width = sqrt(solid_angle) / float(samples);
    vec3 sum = vec3(0.0);
    for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) sum += kernel(steps * (vec2(d) + (vec2(i, j) + 0.5) / float(samples) - 0.5), width, zone);
    return sum * (solid_angle / float(samples * samples));
}

// Column of the picture, or -1 outside. A sphere closes.
int column_of(int x, bool sphere) {
    if (sphere) return (x + int(push.width)) % int(push.width);
    return x < int(push.width) ? max(x, -1) : -1;
}

vec3 excess(vec4 pixel, float threshold) { return max(pixel.rgb - threshold, vec3(0.0)); }

void make_weights(int radius, mat2 steps, float solid_angle, uint zone) {
    const int side = 2 * radius + 1, middle = (side * side - 1) / 2;
    for (int i = int(gl_LocalInvocationIndex); i <= middle; i += int(tile_width * tile_height))
        weights[i] = i == middle ? vec3(0.0) : pixel_weight(ivec2(i % side, i / side) - radius, steps, solid_angle, zone);
}

// Share of the light from a pixel that meets the obstacles as the zone has them.
float share_of(EyeGeometry g, vec2 px, uint zone) {
    return push.zones > 1 ? zone_share(zone_place(geometry_direction(g, px + 0.5), push.zones), zone) : 1.0;
}

// Zones that the light in reach of a tile may be of. On a sphere left and right meet behind the head.
uvec2 zones_in_reach(EyeGeometry g, vec2 low, vec2 high) {
    if (push.zones == 1 || g.kind == geometry_equirect) return uvec2(0, push.zones - 1);
    float least = float(push.zones), most = 0.0;
    for (uint i = 0; i < 4; ++i) {
        const vec2 px = clamp(vec2((i & 1u) == 0 ? low.x : high.x, (i & 2u) == 0 ? low.y : high.y), vec2(0.0), vec2(push.width, push.height));
        const float place = zone_place(geometry_direction(g, px), push.zones);
        least = min(least, place);
        most = max(most, place);
    }
    return uvec2(floor(least), min(ceil(most), float(push.zones - 1)));
}

// Rows first.y .. first.y + tile_height - 1 of the view, from `radius` columns before column first.x to as many behind the tile: light of the zone.
void read_band(EyeGeometry g, uint base, ivec2 first, int radius, float threshold, uint zone) {
    const bool sphere = g.kind == geometry_equirect;
    const uint reach = tile_width + 2 * uint(radius);
    if (gl_LocalInvocationIndex == 0) {
        lit_rows = 0u;
        lit_left = int(reach_width);
        lit_right = -int(reach_width);
    }
    barrier();
    for (uint i = gl_LocalInvocationIndex; i < tile_height * reach; i += tile_width * tile_height) {
        const int row = int(i / reach), column = int(i % reach) - radius, y = first.y + row, x = column_of(first.x + column, sphere);
        vec3 source = vec3(absent);
        if (x >= 0 && y >= 0 && y < int(push.height)) {
            const vec4 pixel = scene[base + uint(y) * push.width + uint(x)];
            if (pixel.w > 0.0) source = excess(pixel, threshold);
        }
        if (source.r != absent && source != vec3(0.0)) source *= share_of(g, vec2(x, y), zone);
        light[uint(row) * reach_width + i % reach] = source;
        if (source.r == absent || source == vec3(0.0)) continue;
        atomicOr(lit_rows, 1u << uint(row));
        atomicMin(lit_left, column);
        atomicMax(lit_right, column);
    }
    barrier();
}

// What a band gives to the pixel of this invocation. `row`: of the band's first row, from that pixel. Only a pixel that has light to lose
// sends some to dark pixels.
vec3 from_band(int row, int radius, vec3 own) {
    const bool loses = own != vec3(0.0);
    const int column = int(gl_LocalInvocationID.x), side = 2 * radius + 1, middle = (side * side - 1) / 2;
    const int first = loses ? -radius : max(-radius, lit_left - column), last = loses ? radius : min(radius, lit_right - column);
    vec3 sum = vec3(0.0);
    for (int k = 0; k < int(tile_height); ++k) {
        const int dy = row + k;
        if (abs(dy) > radius || (!loses && (lit_rows >> uint(k) & 1u) == 0u)) continue;
        const int from = k * int(reach_width) + column + radius;
        for (int dx = first; dx <= last; ++dx) {
            const vec3 there = light[from + dx];
            if (there.r != absent) sum += weights[middle - abs(dy * side + dx)] * (there - own);
        }
    }
    return sum;
}

void main() {
    const uint per_view = push.tiles_x * push.tiles_y;
    for (uint slot = gl_WorkGroupID.x; slot < near_count; slot += gl_NumWorkGroups.x) {
        const uint tile = near_list[slot], view = tile / per_view;
        const uvec2 corner = uvec2(tile % per_view % push.tiles_x, tile % per_view / push.tiles_x) * uvec2(tile_width, tile_height);
        const EyeGeometry g = geometry[view];
        const vec2 middle = min(vec2(corner) + vec2(tile_width, tile_height) * 0.5, vec2(push.width, push.height) - 0.5);
        const vec3 across = (geometry_direction(g, middle + vec2(2, 0)) - geometry_direction(g, middle - vec2(2, 0))) * 0.25;
        const vec3 down = (geometry_direction(g, middle + vec2(0, 2)) - geometry_direction(g, middle - vec2(0, 2))) * 0.25;
        const int radius = int(clamp(ceil(push.near / max(min(length(across), length(down)), 1e-6)), 1.0, float(max_near_px)));
        const uint base = view * push.width * push.height;
        const float threshold = push.near_from < 0.0 ? state[view].tone.scene_white_cd_m2 : push.near_from * state[view].adaptation_cd_m2;
        const uvec2 px = corner + gl_LocalInvocationID.xy;
        const bool inside = px.x < push.width && px.y < push.height;
        const uint at = base + min(px.y, push.height - 1) * push.width + min(px.x, push.width - 1);
        const vec4 here = scene[at];
        const bool wanted = inside && here.w > 0.0;
        const vec3 own = wanted && push.leaves != 0 ? excess(here, threshold) : vec3(0.0);
        barrier();
        if (gl_LocalInvocationIndex == 0) losers = 0u;
        barrier();
        if (own != vec3(0.0)) atomicOr(losers, 1u);
        barrier();
        const int bands = (radius + int(tile_height) - 1) / int(tile_height);
        const uvec2 zones = zones_in_reach(g, vec2(corner) - float(radius), vec2(corner) + vec2(tile_width, tile_height) + float(radius));
        const mat2 steps = pixel_steps(g, geometry_direction(g, middle), across, down);
        vec3 sum = vec3(0.0);
        for (uint zone = zones.x; zone <= zones.y; ++zone) {
            const vec3 own_of_zone = own == vec3(0.0) ? own : own * share_of(g, vec2(px), zone);
            bool have_weights = false;
            for (int band = -bands; band <= bands; ++band) {
                const int row = band * int(tile_height);
                barrier();
                read_band(g, base, ivec2(corner) + ivec2(0, row), radius, threshold, zone);
                if (lit_rows == 0u && losers == 0u) continue;
                if (!have_weights) {
                    make_weights(radius, steps, length(cross(across, down)), zone);
                    have_weights = true;
                    barrier();
                }
                if (wanted) sum += from_band(row - int(gl_LocalInvocationID.y), radius, own_of_zone);
            }
        }
        if (inside) near_light[at] = sum;
    }
}
