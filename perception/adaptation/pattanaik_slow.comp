#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/adaptation/pattanaik_slow_math.glsl"
#include "perception/adaptation/pattanaik_slow_memory.h"
#define AdaptationParams PattanaikSlowParams
#include "perception/adaptation/adaptation_pass.glsl"

layout(scalar, binding = 6) buffer Memory { PattanaikSlowMemory memory[]; };

float settled(float target) {
    memory[push.view] = PattanaikSlowMemory(target, settled_unbleached(rod_pigment(), target), settled_bleached(cone_pigment(), target));
    return target;
}

float stepped(float state, float target) {
    if (!(memory[push.view].neural_cd_m2 > 0.0)) settled(state);     // the user said what the eye was adapted to
    PattanaikSlowMemory m = memory[push.view];
    const float pigment_s = push.dt_s * push.params.time_lapse;
    m.neural_cd_m2 = neural_after(push.params, m.neural_cd_m2, target, push.dt_s);
    m.rod_unbleached = pigment_after(rod_pigment(), m.rod_unbleached, settled_unbleached(rod_pigment(), target), target, pigment_s);
    m.cone_bleached = pigment_after(cone_pigment(), m.cone_bleached, settled_bleached(cone_pigment(), target), target, pigment_s);
    memory[push.view] = m;
    return with_pigment(m.neural_cd_m2, m.rod_unbleached, m.cone_bleached);
}
