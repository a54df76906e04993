// pattanaik_slow after a step of the light, from an eye that has been settled: as pattanaik_slow.comp goes on. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_CURVES_PATTANAIK_STEP_GLSL
#define ENTOPTIC_PERCEPTION_CURVES_PATTANAIK_STEP_GLSL

#include "perception/adaptation/pattanaik_slow_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::pattanaik_slow)

FN real pigment_step(PattanaikSlowParams p, real before, real target, real t_s) {
    real pigment_s = t_s * real(p.time_lapse);
    real rods = pigment_after(rod_pigment(), settled_unbleached(rod_pigment(), before), settled_unbleached(rod_pigment(), target), target, pigment_s);
    real cones = pigment_after(cone_pigment(), settled_bleached(cone_pigment(), before), settled_bleached(cone_pigment(), target), target, pigment_s);
    return with_pigment(neural_after(p, before, target, t_s), rods, cones);
}

ENTOPTIC_MATH_END

#endif
