#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The widest disc of each tile.
#include "perception/dof/liu_range_math.glsl"

#define DOF_PARAMS LiuRangeParams
#include "perception/dof/dof_range.glsl"
