#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// What the light above the threshold does to the pixels around it, into the near light.
// Of the excess over the panel's white, a pixel that is white in every channel gets nothing: the panel shows it as it is.
#include "perception/glare/glare_near.glsl"

layout(scalar, binding = 0) readonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 5) buffer NearLight { vec3 near_light[]; };

bool tile_wanted(uint) { return true; }
float threshold_of(uint view) { return push.near_from < 0.0 ? state[view].tone.scene_white_cd_m2 : push.near_from * state[view].adaptation_cd_m2; }

vec3 source_at(uint at, float threshold) {
    const vec3 above = max(scene[at].rgb - threshold, vec3(0.0));
    return push.turn == 0 ? above : push.turn == 1 ? above.gbr : above.brg;
}
bool visible_at(uint at) { return scene[at].w > 0.0; }
bool wanted_at(uint at, float threshold) {
    const vec4 here = scene[at];
    return here.w > 0.0 && !(push.near_from < 0.0 && min(here.r, min(here.g, here.b)) >= threshold);
}
void store(uint at, vec3 light) { near_light[at] = push.add != 0 ? near_light[at] + light : light; }

void main() { near_tiles(); }
