#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/tone/naka_rushton_math.glsl"

layout(scalar, push_constant) uniform Push {
    NakaRushtonParams params;
    float white_cd_m2;
} push;

#include "perception/tone/curve_plan.glsl"

float displayed_luminance(uint view, float y) {
    return displayed(push.params, response(push.params, y, log2_half_saturation(push.params, state[view].adaptation_cd_m2)), push.white_cd_m2);
}
