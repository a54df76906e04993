// Luminance and the sRGB curve. The one copy of both, in float and in double (shaders/shared_types.h).
#ifndef ENTOPTIC_SHADERS_COLOUR_MATH_GLSL
#define ENTOPTIC_SHADERS_COLOUR_MATH_GLSL

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(colour)

// Photopic luminance of linear BT.709 / D65 colours (ITU-R BT.709-6).
FN real luminance(rvec3 c) { return LIT(0.2126) * c.x + LIT(0.7152) * c.y + LIT(0.0722) * c.z; }

// IEC 61966-2-1: linear 0..1 to encoded 0..1 and back.
FN real srgb_encode(real linear) {
    return linear <= LIT(0.0031308) ? linear * LIT(12.92) : LIT(1.055) * pow(linear, LIT(1.0) / LIT(2.4)) - LIT(0.055);
}
FN real srgb_decode(real encoded) {
    return encoded <= LIT(0.04045) ? encoded / LIT(12.92) : pow((encoded + LIT(0.055)) / LIT(1.055), LIT(2.4));
}

ENTOPTIC_MATH_END

#endif
