#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/curves/curve_settings.h"
#include "perception/glare/fraunhofer_mask_math.glsl"
#define CurveSettings GlarePsf
#include "perception/curves/curve_pass.glsl"

// table: light per sr within the first row, then the rows' means over the azimuth.
float curve_value(float x) {
    const float sine = sin(radians(x));
    if (sine < mask_first_sine()) return table[0];
    const float row = min(mask_row(sine), float(mask_rows - 1u));
    const uint low = min(uint(row), mask_rows - 2u);
    return mix(table[1u + low], table[2u + low], row - float(low)) / (sine * sine * sine);
}
