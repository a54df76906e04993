#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/curves/curve_settings.h"
#include "perception/curves/pupil_in_scene.glsl"
#define CurveSettings PupilDiameter
#define CurveParams ResidualPupilParams
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) { return pupil_in_scene(params, own, x); }
