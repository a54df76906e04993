// For the kernels that work through a list of tiles: which tile this workgroup has. Define LIST_BINDING first. One workgroup is one tile.
#include "perception/acuity/tile_lists.glsl"

layout(scalar, binding = LIST_BINDING) readonly buffer Lists { uint lists[]; };

// False for the workgroups that fill up the last row. `all_tiles` of all views.
bool tile_of_list(uint list, uint all_tiles, uint tiles_x, uint tiles_y, out Tile tile) {
    const uint n = gl_WorkGroupID.y * list_row + gl_WorkGroupID.x;
    const bool there = n < lists[list_count * all_tiles + list];
    tile = tile_at(lists[list * all_tiles + (there ? n : 0u)], tiles_x, tiles_y);
    return there;
}
