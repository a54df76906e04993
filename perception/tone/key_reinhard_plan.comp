#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/tone/key_reinhard_math.glsl"

layout(scalar, push_constant) uniform Push {
    KeyReinhardParams params;
    float white_cd_m2, black_cd_m2;
} push;

#include "perception/tone/curve_plan.glsl"

float displayed_luminance(uint view, float y) {
    return push.black_cd_m2 + (push.white_cd_m2 - push.black_cd_m2) * response(push.params, y, state[view].adaptation_cd_m2);
}
