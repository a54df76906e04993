#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// One layer's distance over those beneath it, in painter's order. One workgroup a tile that the lens shows.
#include "compositor/depth_layer.h"
#include "compositor/layer_view.h"
#include "shaders/geometry.glsl"
#include "shaders/scene_statistics.h"

layout(local_size_x = 32, local_size_y = 8) in;

layout(scalar, binding = 0) uniform Geometry { EyeGeometry geometry[2]; };
layout(scalar, binding = 1) uniform Layers { DepthLayer layers[2 * layer_slots]; };   // layer_slots an eye
layout(scalar, binding = 2) readonly buffer Tiles { uint tile_list[]; };              // x | y << 16
layout(scalar, binding = 3) buffer Dioptre { float dioptre[]; };
layout(binding = 4) uniform sampler2D colour_image;
layout(binding = 5) uniform sampler2D depth_image;

layout(scalar, push_constant) uniform Push {
    uint view;
    uint tiles;               // entries of tile_list
    uint slot;                // 0: nothing is beneath
} push;

vec3 texel_at(vec3 rows[3], vec3 at) {
    const float w = dot(rows[2], at);
    return vec3(vec2(dot(rows[0], at), dot(rows[1], at)) / w, w);
}

// 1/m from the eye, or unknown. The nearest texel: between an edge's two sides there is nothing.
float own_dioptre(DepthLayer layer, vec3 at, float cosine) {
    if ((layer.flags & depth_known) == 0u) return unknown_dioptre;
    float along_axis = layer.dioptre_at_zero;
    if ((layer.flags & depth_sampled) != 0u) {
        const vec2 texel = clamp(texel_at(layer.depth_from_lens, at).xy, layer.depth_low, layer.depth_high);
        const float value = texelFetch(depth_image, ivec2(texel), 0).x;
        if (!(value >= layer.least && value <= layer.most)) return unknown_dioptre;
        along_axis += layer.dioptre_per_unit * value;
    }
    return clamp(along_axis * cosine, 0.0, max_dioptre);
}

// Share of the light that the layer takes away from those beneath it.
float coverage(DepthLayer layer, vec2 texel) {
    if ((layer.flags & depth_blends) == 0u) return 1.0;
    const float alpha = texelFetch(colour_image, ivec2(clamp(texel, layer.low + 0.5, layer.high - 0.5)), 0).w;
    return alpha > 0.0 ? min(alpha, 1.0) : 0.0;
}

void main() {
    const uint index = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (index >= push.tiles) return;
    const uvec2 tile = uvec2(tile_list[index] & 0xffffu, tile_list[index] >> 16);
    const uvec2 pixel = tile * uvec2(tile_width, tile_height) + gl_LocalInvocationID.xy;
    const uvec2 size = uvec2(geometry[push.view].width, geometry[push.view].height);
    if (pixel.x >= size.x || pixel.y >= size.y) return;
    const vec2 px = vec2(pixel) + 0.5;
    const vec2 p = lens_position(geometry[push.view], geometry[push.view].channels[1], px);
    const vec3 at = vec3(p, lens_denominator(geometry[push.view].channels[1], dot(p, p)));
    const DepthLayer layer = layers[push.view * layer_slots + push.slot];

    const uint place = (push.view * size.y + pixel.y) * size.x + pixel.x;
    float result = push.slot == 0u ? unknown_dioptre : dioptre[place];
    const vec3 seen_at = texel_at(layer.colour_from_lens, at);
    const bool seen = seen_at.z > 0.0 && all(greaterThanEqual(seen_at.xy, layer.low)) && all(lessThanEqual(seen_at.xy, layer.high));
    if (seen) {
        const vec2 tangents = lens_tangents(geometry[push.view], geometry[push.view].channels[1], px);
        const float cosine = seen_at.z / (at.z * sqrt(1.0 + dot(tangents, tangents)));
        const float own = own_dioptre(layer, at, cosine), share = coverage(layer, seen_at.xy);
        // What covers more speaks where only one is known; both known, the eye focuses somewhere between.
        if (own >= 0.0 && result >= 0.0) result = mix(result, own, share);
        else if (share >= 0.5) result = own;
    }
    dioptre[place] = result;
}
