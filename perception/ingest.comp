#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// A picture from the CPU becomes the eye image: cleaned, with its tiles' statistics.

#include "shaders/geometry.glsl"
#include "shaders/tile_statistics.glsl"

layout(local_size_x = tile_width, local_size_y = tile_height) in;

layout(scalar, binding = 0) readonly buffer Picture { vec3 picture[]; };
layout(scalar, binding = 1) readonly buffer Geometry { EyeGeometry geometry[]; };
layout(scalar, binding = 2) writeonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 3) writeonly buffer Tiles { TileStatistics tiles[]; };

void main() {
    const uint view = gl_GlobalInvocationID.z;
    const EyeGeometry g = geometry[view];
    const uvec2 at = gl_GlobalInvocationID.xy;
    const bool in_image = at.x < g.width && at.y < g.height;
    const vec2 px = vec2(at) + 0.5;
    const bool visible = in_image && geometry_visible(g, px);
    const uint index = (view * g.height + at.y) * g.width + at.x;
    bool changed = false;
    vec3 c = vec3(0.0);
    if (visible) c = clean_scene_colour(picture[index], changed);
    if (in_image) scene[index] = vec4(c, visible ? 1.0 : 0.0);
    const TileStatistics tile = reduce_tile(c, visible, changed, visible ? geometry_solid_angle(g, px) : 0.0);
    if (gl_LocalInvocationIndex == 0)
        tiles[(view * gl_NumWorkGroups.y + gl_WorkGroupID.y) * gl_NumWorkGroups.x + gl_WorkGroupID.x] = tile;
}
