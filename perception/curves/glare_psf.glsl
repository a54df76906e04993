// Point spread functions of the glare models with their direct light. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_CURVES_GLARE_PSF_GLSL
#define ENTOPTIC_PERCEPTION_CURVES_GLARE_PSF_GLSL

#include "perception/curves/curve_settings.h"
#include "perception/glare/closed_form_math.glsl"
#include "perception/glare/glare_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::glare_psf)
#ifdef __cplusplus
using namespace entoptic::perception::closed_form;
using namespace entoptic::perception::glare;
#endif

// What the pupil and the particles in it do to the light.
struct WaveOptics {
    real pupil_mm;
    real particle_um, covered;    // diameter of a particle; share of the pupil that all of them cover
    real diffraction;             // share of the light that has the tail of the pupil's diffraction
    real fibres;                  // share of the ring of the lens fibres
    real direct;                  // share of the light that is not scattered
};

// Models give the direct light to the pixel that it comes from. Here it has the pupil's Airy pattern up to its third dark ring, from where
// the models' mean over the rings, aperture_tail(), is good to 1 %.
FN real core_end() { return LIT(10.173468135062722); }
FN real core_energy() { return LIT(0.9376474743735); }      // 1 - J0(core_end())²

FN bool in_core(real pupil_mm, real lambda_um, real sine) { return LIT(3141.592653589793) * pupil_mm * sine < core_end() * lambda_um; }

// Per sr and of all light.
FN real direct_light(WaveOptics w, real lambda_um, real sine) {
    return in_core(w.pupil_mm, lambda_um, sine) ? w.direct * disc_scatter(LIT(1e3) * w.pupil_mm, lambda_um, sine) / core_energy() : LIT(0.0);
}

// Without straylight.
FN real scattered_light(WaveOptics w, real lambda_um, real sine, real deg) {
    real tail = in_core(w.pupil_mm, lambda_um, sine) ? LIT(0.0) : aperture_tail(LIT(1e3) * w.pupil_mm, lambda_um, sine);
    real ring = w.fibres > LIT(0.0) ? w.fibres * lenticular_ring(deg, LIT(1e3) * lambda_um) : LIT(0.0);
    return (LIT(1.0) - w.covered) * w.diffraction * tail + w.covered * disc_scatter(w.particle_um, lambda_um, sine) + ring;
}

ENTOPTIC_MATH_END

#endif
