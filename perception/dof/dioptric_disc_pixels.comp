#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Depth and disc of every pixel.
#include "perception/dof/dioptric_disc_math.glsl"

#define DOF_PARAMS DioptricDiscParams
#define DOF_ROWS(params) false
#include "perception/dof/dof_pixels.glsl"
