#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// What the light that was drawn does to the pixels around it, into the scene: beside the sources that it was drawn for, where it is steep.
#include "perception/glare/glare_near.glsl"

layout(scalar, binding = 0) buffer Scene { vec4 scene[]; };
layout(scalar, binding = 5) readonly buffer Drawn { vec3 drawn[]; };
layout(scalar, binding = 6) readonly buffer Flags { uint flags[]; };

bool tile_wanted(uint tile) { return flags[tile] == near_beside; }

float threshold_of(uint) { return 0.0; }
vec3 source_at(uint at, float) { return drawn[at]; }
bool visible_at(uint at) { return scene[at].w > 0.0; }
bool wanted_at(uint at, float) { return scene[at].w > 0.0; }
void store(uint at, vec3 light) { scene[at].rgb += light; }

void main() { near_tiles(); }
