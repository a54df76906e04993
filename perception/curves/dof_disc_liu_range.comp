#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/dof/liu_range_math.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings BlurDisc
#define CurveParams LiuRangeParams
#include "perception/curves/curve_pass.glsl"

// The disc grows with the pixel's angle, so that any pixel will do.
float curve_value(float x) {
    return degrees(2.0 * paper_pixel_rad * blur_radii_px(params, 1.0 / x, 1.0 / own.focus_m, own.pupil_mm, paper_pixel_rad).x);
}
