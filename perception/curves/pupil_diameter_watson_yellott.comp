#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/pupil/watson_yellott_math.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings PupilDiameter
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return clamp(diameter_mm(x * own.area_deg2 * (own.eyes < 1.5 ? 0.1 : 1.0), own.age), 1.5, 9.0); }
