#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/acuity/jacobs_bands_math.glsl"
#include "perception/curves/curve_settings.h"
#include "perception/curves/jacobs_bands_cutoff.glsl"
#define CurveSettings NoSettings
#define CurveParams JacobsBandsParams
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return cutoff_cpd(params, x); }
