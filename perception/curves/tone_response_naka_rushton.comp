#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/tone/naka_rushton_math.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings ToneResponse
#define CurveParams NakaRushtonParams
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return response(params, x, log2_half_saturation(params, own.adapted_to)); }
