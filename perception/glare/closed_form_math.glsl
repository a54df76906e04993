// Straylight of the eye and the ring of the lens fibres. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_GLARE_CLOSED_FORM_MATH_GLSL
#define ENTOPTIC_PERCEPTION_GLARE_CLOSED_FORM_MATH_GLSL

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::closed_form)

// Veiling luminance over illuminance, per sr: CIE 146-2002, general disability glare equation, for 0.1 to 100 degrees.
FN real cie146(real deg, real age, real pigment) {
    real a = age / LIT(62.5);
    a = a * a * a * a;
    return LIT(10.0) / (deg * deg * deg) + (LIT(5.0) / (deg * deg) + LIT(0.1) * pigment / deg) * (LIT(1.0) + a) + LIT(0.0025) * pigment;
}

// The equation as a kernel: level inside 0.1 degrees, where the core is that of the sharp image; ends between 100 and 110 degrees.
// `factor` is what a straylight meter finds at 7 degrees over the norm (van den Berg 2007). It says nothing of the core: choice: it
// holds from 1 degree on and fades to 1 at 0.1 degrees.
FN real straylight(real deg, real age, real pigment, real factor) {
    real end = clamp((LIT(110.0) - deg) / LIT(10.0), LIT(0.0), LIT(1.0));
    real t = clamp(log(max(deg, LIT(0.1)) / LIT(0.1)) / LIT(2.302585092994046), LIT(0.0), LIT(1.0));
    real rise = t * t * (LIT(3.0) - LIT(2.0) * t);
    return cie146(clamp(deg, LIT(0.1), LIT(100.0)), age, pigment) * (LIT(1.0) + (factor - LIT(1.0)) * rise) * end * end * (LIT(3.0) - LIT(2.0) * end);
}

// Straylight of a wavelength over that of 575 nm. The lens and cornea of a dark eye scatter as lambda^-4; in light eyes the wall of the eye
// lets red through, which levels it (Coppens, Franssen and van den Berg 2006); choice: linear in the pigment, level at 1.2.
FN real straylight_colour(real nm, real pigment) {
    real r = LIT(575.0) / nm;
    r = r * r;
    return mix(r * r, LIT(1.0), clamp(pigment / LIT(1.2), LIT(0.0), LIT(1.0)));
}

// Ring of the lens fibres, per sr and of energy 1: Spencer, Shirley, Zimmerman and Greenberg 1995, f3.
FN real lenticular_ring(real deg, real nm) {
    real d = deg - LIT(3.0) * nm / LIT(568.0);
    return LIT(436.9) * (LIT(568.0) / nm) * exp(LIT(-19.75) * d * d);
}
// Its share of the light: fibres stand outside the middle of the lens, where narrow pupils do not reach. Spencer 1995 gives 0.033 for the
// scotopic pupil and 0 for the photopic; choice: linear from 1.9 to 4.9 mm.
FN real lenticular_share(real pupil_mm) { return LIT(0.033) * clamp((pupil_mm - LIT(1.9)) / LIT(3.0), LIT(0.0), LIT(1.0)); }

ENTOPTIC_MATH_END

#endif
