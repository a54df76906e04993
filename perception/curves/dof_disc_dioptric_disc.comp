#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/dof/dioptric_disc_math.glsl"
#include "perception/curves/blur_disc.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings BlurDisc
#define CurveParams DioptricDiscParams
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return disc_deg(params, own, x); }
