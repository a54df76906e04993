// The pass of every curve: one x an invocation. The curve's shader defines CurveSettings (a macro: the struct of its settings), CurveParams (the
// model's parameters; without it there are none) and CURVE_PARTS when a value has several parts, includes this, and gives curve_value(x).
#ifndef CURVE_PARTS
#define CURVE_PARTS 1
#define CurveValue float
#else
#define CurveValue vec3
#endif

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer X { float xs[]; };
layout(scalar, binding = 1) writeonly buffer Y { float ys[]; };
layout(scalar, binding = 2) readonly buffer Settings {
    CurveSettings own;
#ifdef CurveParams
    CurveParams params;
#endif
};
layout(scalar, binding = 3) readonly buffer Table { float table[]; };
layout(scalar, push_constant) uniform Push { uint count; } push;

CurveValue curve_value(float x);

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) return;
    const CurveValue y = curve_value(xs[i]);
#if CURVE_PARTS == 1
    ys[i] = y;
#else
    for (uint part = 0u; part < 3u; ++part) ys[3u * i + part] = y[part];
#endif
}
