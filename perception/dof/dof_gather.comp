#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Each pixel gathers the light of the discs that reach it. What lies behind the pixel reaches it with the smaller of both discs only, so
// that it does not leak over the edge of what is sharp; what lies in front covers it.

#include "perception/dof/dof_gpu.h"
#include "perception/dof/dof_list.glsl"
#include "perception/dof/dof_math.glsl"

layout(local_size_x = tile_width, local_size_y = tile_height) in;

layout(constant_id = 0) const uint colours = 0;         // dof_colours_*
layout(constant_id = 1) const bool roulette = false;    // not every pixel of the disc is looked at (Liu et al. 2021, equations 10 and 11)

layout(scalar, binding = 0) readonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer Pixels { DofPixel pixels[]; };
layout(scalar, binding = 2) readonly buffer Lists { uint lists[]; };
layout(scalar, binding = 3) readonly buffer Reach { float reach_px[]; };
layout(scalar, binding = 4) writeonly buffer Blurred { vec4 blurred[]; };

layout(scalar, push_constant) uniform Push {
    uint width, height, tiles_x, tiles_y, wraps;
} push;

// Shares of the pixel's light of each colour, at (x, y) pixels from where it comes.
vec3 shares(vec3 radius, vec3 side_of, vec2 offset) {
    const float far = length(offset);
    if (colours == dof_colours_lca) return vec3(disc_share(radius.x, far), disc_share(radius.y, far), disc_share(radius.z, far));
    const float share = disc_share(radius.x, far);
    if (colours == dof_colours_rows) return share * row_filter(side_of.y, radius.x, offset.y);
    return vec3(share);
}

void add(inout Gathered sums, DofPixel own, uint index, vec2 offset, float weight) {
    const DofPixel other = pixels[index];
    const bool in_front = other.dioptre > own.dioptre;
    const vec3 radius = in_front ? other.radius_px : min(other.radius_px, own.radius_px);
    const vec3 share = weight * shares(radius, other.radius_px, offset);
    if (!(share.x + share.y + share.z > 0.0)) return;
    const vec3 light = share * scene[index].rgb;
    if (in_front) {
        sums.front += light;
        sums.front_share += share;
    } else {
        sums.behind += light;
        sums.behind_share += share;
    }
}

// Whether the picture has a pixel `offset` from `at`, and which.
bool pixel_at(ivec2 at, ivec2 offset, uint view, out uint index) {
    ivec2 place = at + offset;
    if (push.wraps == 1u) place.x = (place.x + int(push.width)) % int(push.width);
    const bool there = place.x >= 0 && place.y >= 0 && place.x < int(push.width) && place.y < int(push.height);
    index = there ? (view * push.height + uint(place.y)) * push.width + uint(place.x) : 0u;
    return there;
}

void gather_all(inout Gathered sums, DofPixel own, ivec2 at, uint view, float reach) {
    const int n = int(reach + 0.5);
    for (int y = -n; y <= n; ++y)
        for (int x = -n; x <= n; ++x) {
            uint index;
            if (pixel_at(at, ivec2(x, y), view, index)) add(sums, own, index, vec2(x, y), 1.0);
        }
}

// A sunflower of as many points as equation 10 asks for, turned by a hash of the place, so that neighbours look at different ones; the
// pixel itself always counts, as itself. The pattern stands still: noise that flickers is seen more easily than noise that stands.
void gather_some(inout Gathered sums, DofPixel own, ivec2 at, uint view, float reach) {
    uint index;
    pixel_at(at, ivec2(0), view, index);
    add(sums, own, index, vec2(0.0), 1.0);
    const float rim = reach + 0.5, area = 3.14159265 * rim * rim;
    const int n = int(ceil(area * sampling_weight(reach)));
    const float turn = 6.2831853 * fract(52.9829189 * fract(dot(vec2(at), vec2(0.06711056, 0.00583715))));
    for (int k = 0; k < n; ++k) {
        const float r = rim * sqrt((float(k) + 0.5) / float(n)), angle = turn + 2.39996323 * float(k);
        const ivec2 offset = ivec2(round(r * vec2(cos(angle), sin(angle))));
        if (offset != ivec2(0) && pixel_at(at, offset, view, index)) add(sums, own, index, vec2(offset), area / float(n));
    }
}

void main() {
    const uint entry = gl_WorkGroupID.y * dof_list_row + gl_WorkGroupID.x;
    if (entry >= lists[0]) return;
    const uint t = lists[1u + entry], view = t / (push.tiles_x * push.tiles_y);
    const uvec2 corner = uvec2(t % push.tiles_x * tile_width, t / push.tiles_x % push.tiles_y * tile_height);
    const uvec2 at = corner + gl_LocalInvocationID.xy;
    if (at.x >= push.width || at.y >= push.height) return;
    const uint index = (view * push.height + at.y) * push.width + at.x;
    const DofPixel own = pixels[index];
    const float w = scene[index].w;
    if (w == pixel_hidden) {
        blurred[index] = scene[index];
        return;
    }
    Gathered sums = nothing_gathered();
    if (roulette) gather_some(sums, own, ivec2(at), view, reach_px[t]);
    else gather_all(sums, own, ivec2(at), view, reach_px[t]);
    blurred[index] = vec4(gathered_light(sums), w);
}
