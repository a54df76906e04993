#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/acuity/jacobs_bands_math.glsl"

#define PARAMS JacobsBandsParams
#include "perception/acuity/local_blur_map.glsl"
