#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/curves/glare_psf.glsl"
#include "perception/glare/closed_form_params.h"
#define CurveSettings GlarePsf
#define CurveParams ClosedFormParams
#include "perception/curves/curve_pass.glsl"
#include "perception/curves/glare_psf_waves.glsl"

float curve_value(float x) {
    const float fibres = params.lenticular_halo * lenticular_share(own.pupil_mm);
    return sum_of_waves(WaveOptics(own.pupil_mm, params.particle_diameter_um, 0.0, params.diffraction, fibres, 0.0), x,
                        straylight(x, params.age, params.pigment, params.straylight_factor));
}
