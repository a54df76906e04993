// Jacobs et al. 2015, equations 13-15: bands of detail are lost one after the other, the finest first, at random in patches. Compiled in
// float and in double.
#ifndef ENTOPTIC_PERCEPTION_ACUITY_JACOBS_BANDS_MATH_GLSL
#define ENTOPTIC_PERCEPTION_ACUITY_JACOBS_BANDS_MATH_GLSL

#include "perception/acuity/jacobs_bands_params.h"
#include "perception/acuity/local_blur_math.glsl"
#include "perception/residual.glsl"

ENTOPTIC_MATH_BEGIN(perception::jacobs_bands)
#ifdef __cplusplus
using namespace entoptic::perception::local_blur;
#endif

// Gaussians of the bank, of 0.69 to 13 arc minutes: at 13 a scotopic eye's 1.7 cycles per degree are left (trap J9).
const int bands = 18;

// Standard deviation of the bank's Gaussian i, arc minutes: appendix A's 0.75·2^(i/4) pixels on a monitor of 65.5 pixels per degree.
FN real bank_sigma_arcmin(real i) { return LIT(0.686869797) * exp(LIT(0.17328679513998632) * i); }

// Upper and lower end of the mesopic range, log10 cd/m², as jacobs_mesopic has them.
FN rvec2 mesopic_range(JacobsBandsParams p) {
    if (p.range < 0.5) return rvec2(LIT(0.6989700043360189), LIT(-2.301029995663981));
    if (p.range < 1.5) return rvec2(LIT(0.0), LIT(-2.0));
    return rvec2(LIT(1.0), LIT(-3.0));
}

// Equation 13, not clamped.
FN real normalised_level(JacobsBandsParams p, real y) {
    rvec2 m = mesopic_range(p);
    return (log(max(y, LIT(1e-8))) * LIT(0.4342944819032518) - m.y) / (m.x - m.y);
}

// Variance (arcmin²) of what is left of a picture at luminance y. With one X for all bands the sum of equation 14 telescopes: bands from j
// on and the low-pass rest are the bank's Gaussian j - 1. Thresholds are spread evenly over the mesopic range, the finest band's on top
// (traps J6, J7). Between Gaussians it goes smoothly; noise fades out towards the range's top, where nothing is lost.
FN real lost_variance(JacobsBandsParams p, real y, real noise) {
    real rho = normalised_level(p, y);
    rho += real(p.randomness) * noise * clamp(LIT(2.0) * (LIT(1.0) - rho), LIT(0.0), LIT(1.0));
    real lost = real(bands) * (LIT(1.0) - rho) - LIT(1.0);   // index of the Gaussian that is left
    real sigma = bank_sigma_arcmin(clamp(lost, LIT(0.0), real(bands - 1)));
    return sigma * sigma * clamp(lost + LIT(1.0), LIT(0.0), LIT(1.0));
}

// Variance to add, arcmin²: the scene's eye's less the wearer's. Acuity falls with eccentricity as 1/(1 + k·e) in both.
FN real added_variance(JacobsBandsParams p, BothEyes eyes, BlurPlace place) {
    real wearer = p.photographic > 0.5 ? LIT(0.0) : lost_variance(p, eyes.panel, place.noise);
    real wider = real(p.strength) * (LIT(1.0) + real(p.eccentricity_per_deg) * place.eccentricity_deg);
    return wider * wider * max(lost_variance(p, eyes.scene, place.noise) - wearer, LIT(0.0));
}

FN bool needs_blur(JacobsBandsParams p, BothEyes eyes, real ppd) {
    return (p.photographic > 0.5 || eyes.scene < eyes.panel) && ppd > LIT(0.0) && normalised_level(p, eyes.scene) < LIT(1.0);
}

ENTOPTIC_MATH_END

#endif
