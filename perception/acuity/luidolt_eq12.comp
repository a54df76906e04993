#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The blur itself, for any tile and kernel: each dark pixel gathers the lightness around it with its own kernel; pixels that are not
// visible do not count and the weights are renormalised.

#define BLUR_PARAMS LuidoltEq12Params
#include "perception/acuity/luidolt_eq12_blur.glsl"

layout(constant_id = 0) const int radius = 3;     // of the widest kernel, pixels

layout(local_size_x = tile_width, local_size_y = tile_height) in;

float blurred_lightness(int centre, float sigma) {
    float weights[radius + 1];
    float below = inside_share(sigma, 0);
    weights[0] = below;
    for (int k = 1; k <= radius; ++k) {
        const float share = inside_share(sigma, k);
        weights[k] = 0.5 * (share - below);
        below = share;
    }
    float sum = 0.0, seen = 0.0;
    for (int y = -radius; y <= radius; ++y) {
        const int row = centre + y * int(plane_width(push.width));
        float row_sum = 0.0, row_seen = 0.0;
        for (int x = -radius; x <= radius; ++x) {
            const float l = plane[row + x];
            const float w = l < 0.0 ? 0.0 : weights[abs(x)];
            row_sum += w * l;
            row_seen += w;
        }
        sum += weights[abs(y)] * row_sum;
        seen += weights[abs(y)] * row_seen;
    }
    return sum / seen;
}

void main() {
    Tile tile;
    const bool there = tile_of_list(list_rim, push.all_tiles, push.tiles_x, push.tiles_y, tile);
    const uvec2 at = uvec2(tile.x * tile_width, tile.y * tile_height) + gl_LocalInvocationID.xy;
    if (!there || at.x >= push.width || at.y >= push.height) return;
    const uint centre = plane_index(push.width, push.height, tile.view, at);
    const float l = plane[centre];
    if (l < 0.0) return;
    const vec2 place = (vec2(gl_LocalInvocationID.xy) + 0.5) / vec2(tile_width, tile_height);
    const float sigma = blur_sigma_px(push.params, l, local_ppd(tile, place));
    if (sigma <= 0.0) return;
    write_lightness(tile, at, blurred_lightness(int(centre), sigma));
}
