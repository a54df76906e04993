// The list of tiles to blur: its length, then view * tiles_y * tiles_x + y * tiles_x + x of each. One workgroup is one tile.
#ifndef ENTOPTIC_PERCEPTION_DOF_DOF_LIST_GLSL
#define ENTOPTIC_PERCEPTION_DOF_DOF_LIST_GLSL

// Entries of Gate::dispatch.
const uint dof_dispatch_pixels = 0u;
const uint dof_dispatch_tiles = 1u;
// Workgroups come in rows of this many, since a dimension of a dispatch is limited to 65535.
const uint dof_list_row = 1024u;

#endif
