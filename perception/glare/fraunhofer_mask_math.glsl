// The optics of fraunhofer_mask: where a direction lies in the table of diffracted light.
// Compiled in float and in double.
//
// The table holds K theta^3 of the light per sr, K, that is diffracted through sine and azimuth: rows in equal steps of log(sine), columns in
// equal steps of azimuth over half a turn (the PSF of a real mask is symmetric). A streak of constant width, whose light per degree falls
// with 1/theta^2, keeps its value along a column, so that the last row goes on to any angle. Level l holds means over 2^l x 2^l entries.
#ifndef ENTOPTIC_PERCEPTION_GLARE_FRAUNHOFER_MASK_MATH_GLSL
#define ENTOPTIC_PERCEPTION_GLARE_FRAUNHOFER_MASK_MATH_GLSL

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::fraunhofer_mask)

const uint mask_columns = 512u;      // over pi
const uint mask_rows = 1024u;        // to 9 degrees
const uint mask_levels = 8u;
const uint mask_entries = 699040u;   // of all levels

// Between columns, rad; between rows, of log(sine): square cells.
FN real mask_step() { return LIT(0.006135923151542565); }
// Sine of the middle of row 0: 1.3 per mille of a degree and more below any pixel.
FN real mask_first_sine() { return LIT(0.0003); }

FN uint mask_level_start(uint level) {
    uint start = 0u;
    for (uint l = 0u; l < level; ++l) start += (mask_columns >> l) * (mask_rows >> l);
    return start;
}

// Row (in entries of level 0) of a sine; negative within the first row.
FN real mask_row(real sine) { return log(sine / mask_first_sine()) / mask_step(); }
FN real mask_sine(real row) { return mask_first_sine() * exp(row * mask_step()); }
// Column of an offset (right, down), 0 .. mask_columns.
FN real mask_column(rvec2 offset) {
    real azimuth = atan(offset.y, offset.x);
    return (azimuth < LIT(0.0) ? azimuth + LIT(3.141592653589793) : azimuth) / mask_step();
}
// Level whose entries are as large as a square of this width, rad, seen at theta.
FN real mask_level(real theta, real width) { return clamp(log(max(width / (theta * mask_step()), LIT(1.0))) * LIT(1.4426950408889634), LIT(0.0), LIT(7.0)); }

// Eq. 7 of the paper as printed; the one in use is tumblin_sigmoid() of glare_math.glsl.
FN real printed_sigmoid(real x) {
    real power = x > LIT(0.0) ? exp(LIT(0.465) * log(x)) : LIT(0.0);
    return LIT(640.0) * (power + LIT(1.0)) / (power + LIT(20.0));
}

ENTOPTIC_MATH_END

#endif
