#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/adaptation/krawczyk_exp_log_math.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings AdaptationStep
#define CurveParams KrawczykExpLogParams
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return adapted(params, own.from_cd_m2, own.to_cd_m2, x); }
