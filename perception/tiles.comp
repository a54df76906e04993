#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Statistics of the tiles of the eye image: one invocation a tile, pixels in order, so the same image gives the same bits.

#include "shaders/colour_math.glsl"
#include "shaders/scene_statistics.h"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer SolidAngle { float solid_angle[]; };
layout(scalar, binding = 2) writeonly buffer Tiles { TileStatistics tiles[]; };

layout(scalar, push_constant) uniform Push { uint width, height; } push;

void add_pixel(inout TileStatistics tile, vec4 pixel, float sr) {
    if (!(sr > 0.0)) return;
    const float y = luminance(pixel.rgb);
    tile.sum_y_sr += y * sr;
    tile.sum_sr += sr;
    tile.min_y = min(tile.min_y, y);
    tile.max_y = max(tile.max_y, y);
    tile.max_channel = max(tile.max_channel, max(pixel.r, max(pixel.g, pixel.b)));
    tile.cleaned += pixel.w > pixel_visible ? 1u : 0u;
    tile.visible += 1u;
}

void main() {
    const uint across = (push.width + tile_width - 1u) / tile_width, down = (push.height + tile_height - 1u) / tile_height;
    const uint t = gl_GlobalInvocationID.x, view = gl_GlobalInvocationID.z;
    if (t >= across * down) return;
    const uint left = t % across * tile_width, top = t / across * tile_height;
    const uint columns = min(tile_width, push.width - left), rows = min(tile_height, push.height - top);
    TileStatistics tile = TileStatistics(0.0, 0.0, 3e38, 0.0, 0.0, 0u, 0u);
    for (uint y = 0u; y < rows; ++y) {
        const uint row = (view * push.height + top + y) * push.width + left;
        for (uint x = 0u; x < columns; ++x) add_pixel(tile, scene[row + x], solid_angle[row + x]);
    }
    tiles[view * across * down + t] = tile;
}
