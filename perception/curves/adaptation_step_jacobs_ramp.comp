#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/adaptation/jacobs_ramp_math.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings AdaptationStep
#define CurveParams JacobsRampParams
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return adapted(params, own.from_cd_m2, own.to_cd_m2, x); }
