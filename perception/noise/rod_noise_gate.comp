#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/noise/rod_noise_params.h"

#define PARAMS RodNoiseParams
#include "perception/dim_light_gate.glsl"
