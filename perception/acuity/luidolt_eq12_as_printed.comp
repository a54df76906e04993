#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The paper's two 1-D passes, for research: sigma in pixels, the second pass's from the first one's lightness, Lab with a and b kept.

#define LIST_BINDING 1
#include "perception/acuity/luidolt_eq12_tiles.glsl"
#include "perception/acuity/tile_of_list.glsl"

layout(local_size_x = tile_width, local_size_y = tile_height) in;

layout(scalar, binding = 0) buffer Scene { vec4 scene[]; };
layout(scalar, binding = 2) readonly buffer From { float from[]; };
layout(scalar, binding = 3) writeonly buffer To { float to[]; };

layout(scalar, push_constant) uniform Push {
    LuidoltEq12Params params;
    uint width, height, tiles_x, tiles_y, all_tiles;
    uint vertical;          // 0: rows, from -> to; 1: columns, from -> scene
} push;

// Sampled Gaussian of 2·ceil(3 sigma) + 1 taps along `stride`.
float blurred_lightness(int centre, int stride, float sigma) {
    const int radius = int(ceil(3.0 * sigma));
    float sum = 0.0, seen = 0.0;
    for (int k = -radius; k <= radius; ++k) {
        const float l = from[centre + k * stride];
        const float w = l < 0.0 ? 0.0 : exp(-0.5 * float(k * k) / (sigma * sigma));
        sum += w * l;
        seen += w;
    }
    return sum / seen;
}

void main() {
    Tile tile;
    const bool there = tile_of_list(push.vertical == 1u ? list_rim : list_lightness, push.all_tiles, push.tiles_x, push.tiles_y, tile);
    const uvec2 at = uvec2(tile.x * tile_width, tile.y * tile_height) + gl_LocalInvocationID.xy;
    if (!there || at.x >= push.width || at.y >= push.height) return;
    const uint centre = plane_index(push.width, push.height, tile.view, at);
    const float l = from[centre];
    const float sigma = l < 0.0 ? 0.0 : blur_sigma_px(push.params, l, paper_ppd);
    const float blurred = sigma > 0.0 ? blurred_lightness(int(centre), push.vertical == 1u ? int(plane_width(push.width)) : 1, sigma) : l;
    if (push.vertical == 0u) {
        to[centre] = blurred;
        return;
    }
    const uint index = (tile.view * push.height + at.y) * push.width + at.x;
    const vec4 pixel = scene[index];
    // A pixel that neither pass touched keeps its bits.
    if (l >= 0.0 && blurred != lightness(luminance(pixel.rgb))) scene[index] = vec4(with_lightness_in_lab(pixel.rgb, blurred), pixel.w);
}
