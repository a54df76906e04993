// Shared by the kernels that blur lightness by pixel: their bindings and what they do before and after the gathering. Define BLUR_PARAMS, the
// model's struct, first.
#define LIST_BINDING 1
#include "perception/acuity/luidolt_eq12_tiles.glsl"
#include "perception/acuity/tile_of_list.glsl"

layout(scalar, binding = 0) buffer Scene { vec4 scene[]; };
layout(scalar, binding = 2) readonly buffer Plane { float plane[]; };
layout(scalar, binding = 3) readonly buffer Density { float density[]; };   // pixels per degree at the corners of tiles

layout(scalar, push_constant) uniform Push {
    BLUR_PARAMS params;
    uint width, height, tiles_x, tiles_y, all_tiles;
} push;

// Pixels per degree at a place 0..1 within a tile, bilinear between its corners.
float local_ppd(Tile tile, vec2 at) {
    const uint row = push.tiles_x + 1u;
    const uint corner = (tile.view * (push.tiles_y + 1u) + tile.y) * row + tile.x;
    return mix(mix(density[corner], density[corner + 1u], at.x), mix(density[corner + row], density[corner + row + 1u], at.x), at.y);
}

void write_lightness(Tile tile, uvec2 at, float blurred) {
    const uint index = (tile.view * push.height + at.y) * push.width + at.x;
    const vec4 pixel = scene[index];
    scene[index] = vec4(with_luminance(pixel.rgb, luminance(pixel.rgb), luminance_of(blurred)), pixel.w);
}
