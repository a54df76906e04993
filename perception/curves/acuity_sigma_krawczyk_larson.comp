#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/acuity/krawczyk_larson_math.glsl"
#include "perception/curves/curve_settings.h"
#include "perception/curves/krawczyk_larson_angle.glsl"
#define CurveSettings AcuitySigma
#define CurveParams KrawczykLarsonParams
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return blur_arcmin(params, x, own.ppd); }
