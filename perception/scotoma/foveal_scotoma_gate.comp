#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/scotoma/foveal_scotoma_params.h"

#define PARAMS FovealScotomaParams
#include "perception/dim_light_gate.glsl"
