#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/adaptation/krawczyk_exp_linear_math.glsl"
#define AdaptationParams KrawczykExpLinearParams
#include "perception/adaptation/adaptation_pass.glsl"

float settled(float target) { return target; }
float stepped(float state, float target) { return adapted(push.params, state, target, push.dt_s); }
