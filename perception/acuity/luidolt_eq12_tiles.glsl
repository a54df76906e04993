// What the kernels of luidolt_eq12 share: which tiles can hold a blurred pixel, the lists of tiles to work on, and where the lightness
// plane keeps a pixel.
#ifndef ENTOPTIC_PERCEPTION_ACUITY_LUIDOLT_EQ12_TILES_GLSL
#define ENTOPTIC_PERCEPTION_ACUITY_LUIDOLT_EQ12_TILES_GLSL

#include "perception/acuity/luidolt_eq12_math.glsl"
#include "shaders/scene_statistics.h"

// A tile whose darkest pixel reached this luminance in the warp holds no pixel below sharp_cd_m2 now. Glare ran in between: it may take
// light from a pixel, its halo's share, which is far below the half that is allowed for here.
const float dark_tile_cd_m2 = 2.0 * sharp_cd_m2;

// Lists of tiles, one after the other, each with room for all tiles of all views. Entry: view * tiles_y * tiles_x + y * tiles_x + x.
const uint list_lightness = 0u;    // tiles whose lightness is needed
const uint list_interior = 1u;     // dark tiles that are visible all around: no pixel meets the edge of the picture or of the lens
const uint list_rim = 2u;          // the other dark tiles
// Workgroups come in rows of this many, since a dimension of a dispatch is limited to 65535.
const uint list_row = 1024u;

// Place of a tile.
struct Tile {
    uint view, x, y, index;
};
Tile tile_at(uint entry, uint tiles_x, uint tiles_y) {
    return Tile(entry / (tiles_x * tiles_y), entry % tiles_x, entry / tiles_x % tiles_y, entry);
}

// The plane of lightness has a border of max_radius_px pixels on each side; border and invisible pixels hold -1.
uint plane_width(uint width) { return width + 2u * uint(max_radius_px); }
uint plane_index(uint width, uint height, uint view, uvec2 at) {
    return (view * (height + 2u * uint(max_radius_px)) + at.y + uint(max_radius_px)) * plane_width(width) + at.x + uint(max_radius_px);
}

#endif
