#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/mesopic/mes2_math.glsl"

#define PARAMS Mes2Params
#include "perception/mesopic/rod_vision_pixels.glsl"
