#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/curves/curve_settings.h"
#include "perception/glare/cie135_math.glsl"
#include "perception/glare/cie135_params.h"
#define CurveSettings GlarePsf
#define CurveParams Cie135Params
#include "perception/curves/curve_pass.glsl"

// table[0]: what the published function sums to.
float curve_value(float x) { return total_psf(x, params.age, params.pigment) / table[0]; }
