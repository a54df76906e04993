#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The near field at full resolution, for tiles on the list: what the light above the threshold does to the pixels around it. One workgroup a
// tile; the kernel is made for the tile's own pixels per degree and place in the zones.
#include "perception/glare/fraunhofer_mask_gpu.h"
#include "perception/glare/glare_gpu.h"
#include "perception/glare/glare_math.glsl"
#include "perception/observer_state.h"
#include "shaders/geometry.glsl"
#include "shaders/scene_statistics.h"

layout(local_size_x = 32, local_size_y = 8) in;
const uint max_side = 2 * max_near_px + 1;

layout(scalar, binding = 0) readonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 2) readonly buffer NearTiles { uint near_count; uint near_list[]; };
layout(scalar, binding = 3) readonly buffer Geometry { EyeGeometry geometry[]; };
layout(scalar, binding = 4) readonly buffer Table { vec3 mask_table[]; };     // parity, zone, entry
layout(scalar, binding = 5) buffer NearLight { vec3 near_light[]; };

layout(scalar, push_constant) uniform PushBlock { MaskNearPush push; };

#include "perception/glare/fraunhofer_mask_lookup.glsl"

shared vec3 weights[max_side * max_side];
shared uint lit_rows;      // a bit for each row of pixels, from max_near_px above the tile to as many below, that holds light above the threshold

// One table or a mixture of the next two zones', and of the two tables between which the eye is.
vec3 kernel(vec2 offset, float width, float place) {
    vec3 sum = vec3(0.0);
    for (uint z = uint(place); z < min(uint(place) + 2, push.zones); ++z) {
        const float share = zone_share(place, z);
        if (share <= 0.0) continue;
        const uint at = z * mask_entries;
        if (push.blend < 1.0) sum += share * (1.0 - push.blend) * mask_kernel(push.first_entry + at, offset, width);
        if (push.blend > 0.0) sum += share * push.blend * mask_kernel(push.second_entry + at, offset, width);
    }
    return sum * (push.strength * near_share(length(offset), push.near));
}

// Steps of one pixel to the side and down as offsets on the glare grid: right and down, rad.
mat2 pixel_steps(EyeGeometry g, vec3 middle, vec3 across, vec3 down) {
    vec3 forward = vec3(0.0, 0.0, -1.0);
    if (g.kind == geometry_equirect) {     // the face of the cube that the grid has there
        const vec3 size = abs(middle);
        forward = size.x > max(size.y, size.z) ? vec3(sign(middle.x), 0.0, 0.0) : size.y > size.z ? vec3(0.0, sign(middle.y), 0.0)
                                                                                                 : vec3(0.0, 0.0, sign(middle.z));
    }
    const vec3 helper = abs(forward.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, -1.0), right = normalize(cross(forward, helper));
    const vec3 up = cross(right, forward);
    return mat2(grid_offset(right, up, forward, 1.0, middle + 0.5 * across) - grid_offset(right, up, forward, 1.0, middle - 0.5 * across),
                grid_offset(right, up, forward, 1.0, middle + 0.5 * down) - grid_offset(right, up, forward, 1.0, middle - 0.5 * down));
}

// Integral of the kernel over the pixel at d, sr.
vec3 pixel_weight(ivec2 d, mat2 steps, float solid_angle, float place) {
    const int samples = max(abs(d.x), abs(d.y)) <= 2 ? 8 : 3;
    const float width = sqrt(solid_angle) / float(samples);
    vec3 sum = vec3(0.0);
    for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) sum += kernel(steps * (vec2(d) + (vec2(i, j) + 0.5) / float(samples) - 0.5), width, place);
    return sum * (solid_angle / float(samples * samples));
}

// Column of the picture, or -1 outside. A sphere closes.
int column_of(int x, bool sphere) {
    if (sphere) return (x + int(push.width)) % int(push.width);
    return x < int(push.width) ? max(x, -1) : -1;
}

vec3 excess(vec4 pixel, float threshold) {
    return max(pixel.rgb - threshold, vec3(0.0));
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
        const vec3 towards = geometry_direction(g, middle);
        const mat2 steps = pixel_steps(g, towards, across, down);
        const float place = zone_place(towards, push.zones);
        // Where is light at all? A lamp fills few of the rows in reach.
        barrier();
        if (lane == 0) lit_rows = 0u;
        barrier();
        const uint reach_x = tile_width + 2 * uint(radius), reach_y = tile_height + 2 * uint(radius);
        for (uint i = lane; i < reach_x * reach_y; i += tile_width * tile_height) {
            const int row = int(i / reach_x) - radius, y = int(corner.y) + row, x = column_of(int(corner.x + i % reach_x) - radius, sphere);
            if (x < 0 || y < 0 || y >= int(push.height)) continue;
            const vec4 pixel = scene[base + uint(y) * push.width + uint(x)];
            if (max(pixel.r, max(pixel.g, pixel.b)) > threshold) atomicOr(lit_rows, 1u << uint(row + int(max_near_px)));
        }
        barrier();
        const uint lit = lit_rows;
        const uvec2 px = corner + gl_LocalInvocationID.xy;
        const bool inside = px.x < push.width && px.y < push.height;
        const uint at = base + px.y * push.width + px.x;
        if (lit == 0u) {
            if (inside) near_light[at] = vec3(0.0);
            continue;
        }
        for (uint i = lane; i < uint(side * side); i += tile_width * tile_height) {
            const ivec2 d = ivec2(int(i) % side, int(i) / side) - radius;
            weights[i] = d == ivec2(0) ? vec3(0.0) : pixel_weight(d, steps, solid_angle, place);
        }
        barrier();
        if (!inside) continue;
        const vec4 here = scene[at];
        const vec3 own = push.leaves != 0 ? excess(here, threshold) : vec3(0.0);
        vec3 sum = vec3(0.0);
        for (int dy = -radius; dy <= radius; ++dy) {
            const int y = int(px.y) + dy;
            if (y < 0 || y >= int(push.height)) continue;
            // Rows without light matter only to pixels that have some to lose.
            const bool row_lit = (lit >> uint(y - int(corner.y) + int(max_near_px)) & 1u) != 0u;
            if (!row_lit && own == vec3(0.0)) continue;
            for (int dx = -radius; dx <= radius; ++dx) {
                const int x = column_of(int(px.x) + dx, sphere);
                if (x < 0) continue;
                const vec4 there = scene[base + uint(y) * push.width + uint(x)];
                if (there.w > 0.0) sum += weights[(dy + radius) * side + dx + radius] * (excess(there, threshold) - own);
            }
        }
        near_light[at] = here.w > 0.0 ? sum : vec3(0.0);
    }
}
