#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/dof/dof_math.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings NoSettings
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return chromatic_dioptre(1e-3 * x); }
