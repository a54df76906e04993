#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/afterimage/jacobs_math.glsl"
#include "perception/curves/jacobs_steps.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings CalciumStep
#define CurveParams JacobsParams
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return calcium_after_step(params, own, x); }
