// The table of diffracted light, read. Include after declaring the buffer `mask_table`.
#ifndef ENTOPTIC_PERCEPTION_GLARE_FRAUNHOFER_MASK_LOOKUP_GLSL
#define ENTOPTIC_PERCEPTION_GLARE_FRAUNHOFER_MASK_LOOKUP_GLSL

#include "perception/glare/fraunhofer_mask_math.glsl"

// K theta^3 of a level, between entries. An entry of row r stands for rows r - 1/2 .. r + 1/2, one of column c for c .. c + 1.
vec3 mask_value(uint first, uint level, float row, float column) {
    const uint columns = mask_columns >> level, rows = mask_rows >> level;
    const float scale = 1.0 / float(1u << level);
    const float y = clamp((row + 0.5) * scale - 0.5, 0.0, float(rows - 1)), x = column * scale - 0.5 + float(columns);
    const uint r = min(uint(y), rows - 2), c = uint(x);
    const uint base = first + mask_level_start(level) + r * columns, left = c % columns, right = (c + 1) % columns;
    const float across = x - float(c);
    return mix(mix(mask_table[base + left], mask_table[base + right], across),
               mix(mask_table[base + columns + left], mask_table[base + columns + right], across), y - float(r));
}

// Light diffracted per sr to an offset (right, down; rad), as a mean over a square of this width about it: that of theta^-3 is by its Laplacian,
// 9 theta^-5, larger than in the middle.
vec3 mask_kernel(uint first, vec2 offset, float width) {
    const float theta = length(offset), sine = sin(min(theta, 1.5707963)), share = width / theta;
    // The finer of two levels: between entries there is interpolation, which widens them.
    const uint level = uint(mask_level(theta, width));
    return mask_value(first, level, mask_row(sine), mask_column(offset)) * ((1.0 + 0.375 * share * share) / (sine * sine * sine));
}

#endif
