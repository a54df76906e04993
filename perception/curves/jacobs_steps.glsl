// The states of afterimages after a step, as the model's advanced() has them. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_CURVES_JACOBS_STEPS_GLSL
#define ENTOPTIC_PERCEPTION_CURVES_JACOBS_STEPS_GLSL

#include "perception/afterimage/jacobs_math.glsl"
#include "perception/curves/curve_settings.h"

ENTOPTIC_MATH_BEGIN(perception::jacobs)
#ifdef __cplusplus
using entoptic::perception::curve_settings::CalciumStep;
using entoptic::perception::curve_settings::Flash;
#endif

FN Drive white_drive(real light, real response) {
    Drive d;
    d.light = rvec3(light, light, light);
    d.response = rvec3(response, response, response);
    return d;
}

// Bleached shares of L, M and S cones t_s after a white flash began, from a rested eye.
FN rvec3 bleached_by_flash(JacobsParams p, Flash flash, real t_s) {
    Cell cell = advanced(p, rested(), white_drive(flash.luminance, LIT(0.0)), min(t_s, flash.duration_s));
    return advanced(p, cell, no_drive(), t_s - flash.duration_s).bleached;
}

// C/C_max t_s after the response went from one constant to another.
FN real calcium_after_step(JacobsParams p, CalciumStep responses, real t_s) {
    Cell cell = steady(p, white_drive(LIT(0.0), responses.from_response));
    return LIT(1.0) - advanced(p, cell, white_drive(LIT(0.0), responses.to_response), t_s).depleted.x;
}

ENTOPTIC_MATH_END

#endif
