#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The blur for any tile: each pixel gathers the lightness around it as far as its own kernel reaches; pixels that are not visible do not
// count and the weights are renormalised.

#include "perception/acuity/krawczyk_larson_math.glsl"
#define BLUR_PARAMS KrawczykLarsonParams
#include "perception/acuity/luidolt_eq12_blur.glsl"

layout(local_size_x = tile_width, local_size_y = tile_height) in;

float blurred_lightness(int centre, float sigma) {
    const int reach = min(kernel_radius(sigma), max_radius_px);
    float weights[max_radius_px + 1];
    float below = 0.0;
    for (int k = 0; k <= reach; ++k) {
        const float share = inside_share(sigma, k);
        weights[k] = (k == 0 ? 1.0 : 0.5) * (share - below);
        below = share;
    }
    float sum = 0.0, seen = 0.0;
    for (int y = -reach; y <= reach; ++y) {
        const int row = centre + y * int(plane_width(push.width));
        float row_sum = 0.0, row_seen = 0.0;
        for (int x = -reach; x <= reach; ++x) {
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
    const float sigma = acuity_sigma_px(push.params, l, local_ppd(tile, (vec2(gl_LocalInvocationID.xy) + 0.5) / vec2(tile_width, tile_height)));
    if (sigma > 0.0) write_lightness(tile, at, blurred_lightness(int(centre), sigma));
}
