// Luidolt et al. 2020, equation 14: in the dark, colours go over into one bluish-purple tint. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_MESOPIC_LUIDOLT_TINT_MATH_GLSL
#define ENTOPTIC_PERCEPTION_MESOPIC_LUIDOLT_TINT_MATH_GLSL

#include "perception/mesopic/luidolt_tint_params.h"
#include "shaders/colour_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::luidolt_tint)
#ifdef __cplusplus
using namespace entoptic::colour;
#endif

// The rods' share 0..1 for an eye adapted to A (cd/m²): equation 4, or with a cut s' = max(0, (s - s_cut)/(1 - s_cut)), 0 from the cut on.
FN real rod_share(LuidoltTintParams p, real adaptation) {
    real s = LIT(0.04) / (LIT(0.04) + max(adaptation, LIT(0.0)));
    if (p.cut_cd_m2 > 0.0) {
        real at_cut = LIT(0.04) / (LIT(0.04) + real(p.cut_cd_m2));
        s = max((s - at_cut) / (LIT(1.0) - at_cut), LIT(0.0));
    }
    return s * real(p.strength);
}

// The tint, of luminance 1 unless as printed (whose luminance is 1.0087).
FN rvec3 tint(LuidoltTintParams p) {
    rvec3 t = rvec3(real(p.tint_r), real(p.tint_g), real(p.tint_b));
    return p.as_printed > 0.5 ? t : t / max(luminance(t), LIT(1e-6));
}

// Equation 14 for one pixel: display light 0..1 in and out. L' is the pixel's own tone-mapped luminance (trap L19); what exceeds the
// display's white is clamped (trap L23).
FN rvec3 tinted(rvec3 rgb, rvec3 tint_colour, real share) {
    rvec3 sum = rgb * (LIT(1.0) - share) + tint_colour * (luminance(rgb) * share);
    return clamp(sum, rvec3(LIT(0.0), LIT(0.0), LIT(0.0)), rvec3(LIT(1.0), LIT(1.0), LIT(1.0)));
}

// Largest change of any displayed 8-bit sRGB code for any colour. Upwards the change of light is share·(t·L' - c) a channel; in codes it
// is largest where c = 0 and the other two channels are full, L' = 1 - w, since the curve is steepest at black: 255·12.92 codes a unit.
// Downwards it is at most share·c, and c times the curve's slope is at most 1.055/2.4, below 1.
FN real bound_codes(LuidoltTintParams p, real share) {
    rvec3 t = tint(p);
    real up = max(t.x * LIT(0.7874), max(t.y * LIT(0.2848), t.z * LIT(0.9278)));
    return share * LIT(255.0) * max(LIT(12.92) * up, LIT(1.0));
}

ENTOPTIC_MATH_END

#endif
