// Small floating-point formats in which a picture could be kept between passes, as bits.
#ifndef ENTOPTIC_PERCEPTION_STORAGE_STORAGE_FORMATS_GLSL
#define ENTOPTIC_PERCEPTION_STORAGE_STORAGE_FORMATS_GLSL

const float least_normal = 6.103515625e-05;  // 2^-14, of every format with five bits of exponent

// A float without a sign, five bits of exponent and `mantissa` bits, of v >= 0: rounded to nearest, ties to even; what is too large becomes
// the largest.
uint small_float(float v, uint mantissa) {
    const uint largest = (31u << mantissa) - 1u;
    if (!(v >= least_normal)) return uint(roundEven(v * exp2(14.0 + float(mantissa))));  // denormals, evenly spaced
    const uint bits = floatBitsToUint(v), shift = 23u - mantissa;
    const uint rounded = bits + (1u << (shift - 1u)) - 1u + ((bits >> shift) & 1u);
    return min((rounded >> shift) - (112u << mantissa), largest);
}
float from_small_float(uint code, uint mantissa) {
    const uint exponent = code >> mantissa, fraction = code & ((1u << mantissa) - 1u);
    if (exponent == 0u) return float(fraction) * exp2(-14.0 - float(mantissa));
    return uintBitsToFloat(((exponent + 112u) << 23) | (fraction << (23u - mantissa)));
}

// B10G11R11: no sign, six bits of mantissa for red and green, five for blue.
uint pack_r11g11b10(vec3 c) { return small_float(c.r, 6u) | (small_float(c.g, 6u) << 11) | (small_float(c.b, 5u) << 22); }
vec3 unpack_r11g11b10(uint code) {
    return vec3(from_small_float(code & 0x7FFu, 6u), from_small_float((code >> 11) & 0x7FFu, 6u), from_small_float(code >> 22, 5u));
}

// E5B9G9R9: nine bits a channel and one exponent for all, as VK_FORMAT_E5B9G9R9_UFLOAT_PACK32 has it.
uint pack_rgb9e5(vec3 c) {
    const vec3 clamped = clamp(c, 0.0, 65408.0);
    const float top = max(clamped.r, max(clamped.g, clamped.b));
    int exponent = max(int(floatBitsToUint(top) >> 23) - 127, -16) + 16;
    if (floor(top / exp2(float(exponent - 24)) + 0.5) >= 512.0) ++exponent;
    const uvec3 mantissa = uvec3(floor(clamped / exp2(float(exponent - 24)) + 0.5));
    return mantissa.r | (mantissa.g << 9) | (mantissa.b << 18) | (uint(exponent) << 27);
}
vec3 unpack_rgb9e5(uint code) { return vec3(code & 511u, (code >> 9) & 511u, (code >> 18) & 511u) * exp2(float(code >> 27) - 24.0); }

#endif
