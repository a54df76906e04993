#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/tone/display_identity_math.glsl"
#include "perception/curves/display_identity_scene.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings ToneResponse
#define CurveParams DisplayIdentityParams
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return shown_of_scene(params, own, x, 130.0, 0.04) / 130.0; }
