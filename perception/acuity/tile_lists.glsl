// Lists of the tiles that a model works on: the GPU makes them, indirect dispatches work through them.
#ifndef ENTOPTIC_PERCEPTION_ACUITY_TILE_LISTS_GLSL
#define ENTOPTIC_PERCEPTION_ACUITY_TILE_LISTS_GLSL

#include "shaders/scene_statistics.h"

// One list after the other, each with room for all tiles of all views, then the lists' lengths. Entry: (view * tiles_y + y) * tiles_x + x.
const uint list_count = 3u;
// Workgroups come in rows of this many, since a dimension of a dispatch is limited to 65535.
const uint list_row = 1024u;

// Place of a tile.
struct Tile {
    uint view, x, y, index;
};
Tile tile_at(uint entry, uint tiles_x, uint tiles_y) {
    return Tile(entry / (tiles_x * tiles_y), entry % tiles_x, entry / tiles_x % tiles_y, entry);
}

#endif
