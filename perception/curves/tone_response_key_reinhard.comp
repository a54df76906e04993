#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/tone/key_reinhard_math.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings ToneResponse
#define CurveParams KeyReinhardParams
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return response(params, x, own.adapted_to); }
