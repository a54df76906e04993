// Light to panel codes. Included by fused.comp, lens.comp and panel.comp.
#ifndef ENTOPTIC_COMPOSITOR_PANEL_GLSL
#define ENTOPTIC_COMPOSITOR_PANEL_GLSL

#include "compositor/panel_curve.h"
#include "shaders/colour_math.glsl"

// Noise of a pixel: three numbers in (-1/2, 1/2), each a multiple of 1/1024 plus 1/2048. Depends on the counters only.
// 32-bit finaliser of MurmurHash3 (Appleby 2011, public domain).
vec3 dither_noise(uint pixel, uint frame) {
    uint h = pixel + frame * 0x9e3779b9u;
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    h = h ^ (h >> 16);
    return (vec3(h & 1023u, (h >> 10) & 1023u, (h >> 20) & 1023u) + 0.5) * (1.0 / 1024.0) - 0.5;
}

float panel_value(PanelCurve curve, float light) {
    return srgb_encode(clamp((light - curve.black_cd_m2) * curve.inverse_range, 0.0, 1.0)) * 255.0;
}

// Codes with fractions, 0..255, to whole ones. `pixel` counts pixels of both eyes.
uint dithered(vec3 value, PanelCurve curve, uint pixel) {
    const uvec3 code = uvec3(value + dither_noise(pixel, curve.frame) * curve.dither + 0.5);
    return code.x | code.y << 8 | code.z << 16 | 0xff000000u;
}

uint panel_codes(PanelCurve curve, vec3 light, uint pixel) {
    return dithered(vec3(panel_value(curve, light.x), panel_value(curve, light.y), panel_value(curve, light.z)), curve, pixel);
}

#endif
