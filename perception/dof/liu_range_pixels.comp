#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Depth and disc of every pixel.
#include "perception/dof/liu_range_math.glsl"

#define DOF_PARAMS LiuRangeParams
#define DOF_ROWS(params) ((params).lca > 0.5)
#include "perception/dof/dof_pixels.glsl"
