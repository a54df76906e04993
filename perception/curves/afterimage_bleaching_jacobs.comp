#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/afterimage/jacobs_math.glsl"
#include "perception/curves/jacobs_steps.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings Flash
#define CurveParams JacobsParams
#define CURVE_PARTS 3
#include "perception/curves/curve_pass.glsl"

vec3 curve_value(float x) { return bleached_by_flash(params, own, x); }
