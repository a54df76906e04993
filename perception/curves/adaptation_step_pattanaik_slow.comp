#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/adaptation/pattanaik_slow_math.glsl"
#include "perception/curves/pattanaik_step.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings AdaptationStep
#define CurveParams PattanaikSlowParams
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return pigment_step(params, own.from_cd_m2, own.to_cd_m2, x); }
