// What the kernels of luidolt_eq12 share: the lists of tiles, and where the lightness plane keeps a pixel.
#ifndef ENTOPTIC_PERCEPTION_ACUITY_LUIDOLT_EQ12_TILES_GLSL
#define ENTOPTIC_PERCEPTION_ACUITY_LUIDOLT_EQ12_TILES_GLSL

#include "perception/acuity/luidolt_eq12_math.glsl"
#include "perception/acuity/tile_lists.glsl"

// Its lists of tiles.
const uint list_lightness = 0u;    // tiles whose lightness is needed
const uint list_interior = 1u;     // dark tiles that are visible all around: no pixel meets the edge of the picture or of the lens
const uint list_rim = 2u;          // the other dark tiles

// The plane of lightness has a border of max_radius_px pixels on each side; border and invisible pixels hold -1.
uint plane_width(uint width) { return width + 2u * uint(max_radius_px); }
uint plane_index(uint width, uint height, uint view, uvec2 at) {
    return (view * (height + 2u * uint(max_radius_px)) + at.y + uint(max_radius_px)) * plane_width(width) + at.x + uint(max_radius_px);
}

#endif
