#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/acuity/krawczyk_larson_math.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings NoSettings
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return resolved_cpd(x); }
