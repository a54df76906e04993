// residual_pupil for a wearer whose own pupil is that of the formula. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_CURVES_PUPIL_IN_SCENE_GLSL
#define ENTOPTIC_PERCEPTION_CURVES_PUPIL_IN_SCENE_GLSL

#include "perception/curves/curve_settings.h"
#include "perception/pupil/residual_pupil_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::residual_pupil)
#ifdef __cplusplus
using entoptic::perception::curve_settings::PupilDiameter;
#endif

// Settled, before a panel of 20 cd/m² as the mean.
FN real pupil_in_scene(ResidualPupilParams p, PupilDiameter own, real y) {
    real area = own.area_deg2 * (own.eyes < LIT(1.5) ? LIT(0.1) : LIT(1.0));
    p.age = float(own.age);
    real measured = diameter_mm(LIT(20.0) * area, own.age);
    return simulated_mm(p, measured, opening_mm(p, y, LIT(20.0), area));
}

ENTOPTIC_MATH_END

#endif
