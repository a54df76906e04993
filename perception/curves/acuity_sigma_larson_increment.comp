#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "perception/acuity/larson_increment_math.glsl"
#include "perception/curves/curve_settings.h"
#define CurveSettings AcuitySigma
#define CurveParams LarsonIncrementParams
#include "perception/curves/curve_pass.glsl"

float curve_value(float x) {
    LarsonIncrementParams p = params;
    p.photographic = own.displayed > 0.0 ? 0.0 : 1.0;
    return sqrt(added_variance(p, BothEyes(x, own.displayed), BlurPlace(0.0, 0.0, own.ppd > 0.0 ? own.ppd : 1e9)));
}
