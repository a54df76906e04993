// How the panel turns codes into light, and the dither. One struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_COMPOSITOR_PANEL_CURVE_H
#define ENTOPTIC_COMPOSITOR_PANEL_CURVE_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::compositor {
#endif

// light = black + (white - black) * srgb_decode(code / 255)
struct PanelCurve {
    float black_cd_m2;
    float inverse_range;  // 1 / (white - black)
    float dither;  // amplitude of the noise over ±1/2 code: 0.98, or 0 for none. Below 1, so that light of an exact code stays that code.
    uint frame;    // counts frames; seeds the noise
};

#ifdef __cplusplus
static_assert(sizeof(PanelCurve) == 16, "scalar layout: the GLSL side must agree");
}  // namespace entoptic::compositor
#endif

#endif
