#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/foveation/visual_polar_math.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings PolarMap
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return fitted_eccentricity_of_radial(x, own.max_deg); }
