#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/mesopic/jacobs_mesopic_math.glsl"

#define PARAMS JacobsMesopicParams
#include "perception/mesopic/rod_vision_gate.glsl"
