#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/mesopic/luidolt_tint_math.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings NoSettings
#define CurveParams LuidoltTintParams
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return 1.0 - rod_share(params, x); }
