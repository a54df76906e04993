#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The same blur for tiles that are visible all around, for kernels of up to max_interior_radius: an invocation does a column of the
// tile, so that a loaded row of lightness serves all the pixels above and below it (12 loads a pixel instead of 49).

#define BLUR_PARAMS LuidoltEq12Params
#include "perception/acuity/luidolt_eq12_blur.glsl"

layout(constant_id = 0) const int radius = 3;     // of the widest kernel, pixels

layout(local_size_x = tile_width) in;

const int rows = int(tile_height);

void main() {
    Tile tile;
    const bool there = tile_of_list(list_interior, push.all_tiles, push.tiles_x, push.tiles_y, tile);
    if (!there) return;
    const uvec2 top = uvec2(tile.x * tile_width + gl_LocalInvocationID.x, tile.y * tile_height);
    const int centre = int(plane_index(push.width, push.height, tile.view, top)), pitch = int(plane_width(push.width));
    float weights[rows][radius + 1], sums[rows], sigmas[rows];
    for (int j = 0; j < rows; ++j) {
        const vec2 place = (vec2(float(gl_LocalInvocationID.x), float(j)) + 0.5) / vec2(tile_width, tile_height);
        sigmas[j] = blur_sigma_px(push.params, plane[centre + j * pitch], local_ppd(tile, place));
        const float sigma = max(sigmas[j], 1e-3);
        float below = 0.0;
        for (int k = 0; k <= radius; ++k) {
            const float share = inside_share(sigma, k);
            weights[j][k] = (k == 0 ? 1.0 : 0.5) * (share - below);
            below = share;
        }
        // Both axes' weights must sum to 1: divide each by what the kernel holds.
        for (int k = 0; k <= radius; ++k) weights[j][k] /= below;
        sums[j] = 0.0;
    }
    for (int y = -radius; y < rows + radius; ++y) {
        float pairs[radius + 1];
        const int row = centre + y * pitch;
        pairs[0] = plane[row];
        for (int k = 1; k <= radius; ++k) pairs[k] = plane[row - k] + plane[row + k];
        for (int j = 0; j < rows; ++j) {
            if (abs(y - j) > radius) continue;
            float across = 0.0;
            for (int k = 0; k <= radius; ++k) across += weights[j][k] * pairs[k];
            sums[j] += weights[j][abs(y - j)] * across;
        }
    }
    for (int j = 0; j < rows; ++j)
        if (sigmas[j] > 0.0) write_lightness(tile, top + uvec2(0u, uint(j)), sums[j]);
}
