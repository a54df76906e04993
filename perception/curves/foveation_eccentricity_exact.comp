#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/foveation/polar_map_math.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings PolarMap
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return exact_eccentricity_deg(x, own.max_deg); }
