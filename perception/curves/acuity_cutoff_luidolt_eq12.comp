#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/acuity/luidolt_eq12_math.glsl"
#include "perception/curves/luidolt_eq12_angle.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings NoSettings
#define CurveParams LuidoltEq12Params
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return cutoff_cpd(params, x); }
