#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/mesopic/mes2_math.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings NoSettings
#define CurveParams Mes2Params
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return cone_share(params, max(x, 1e-9)); }
