// A complex transform of a line of fft_n = 64, 128, 256 or 512 values by fft_n / 8 invocations: Stockham, radix 8 twice and what is left of the size
// once, exchange in shared memory. Include after declaring
//   fft_n, lines       values of a line, lines of a workgroup: both from specialization constants
//   twiddle            a buffer of exp(-2 pi i n / 512), n from 0 to 511, made in double
#ifndef ENTOPTIC_PERCEPTION_GLARE_FFT_LINE_GLSL
#define ENTOPTIC_PERCEPTION_GLARE_FFT_LINE_GLSL

#include "perception/glare/glare_gpu.h"

// One more place after every 8 values, so that strides of 8 fall into different banks.
shared vec2 fft_exchange[lines * (fft_n + fft_n / 8)];

uint fft_place(uint line, uint i) { return line * (fft_n + fft_n / 8) + i + (i >> 3); }

vec2 complex_product(vec2 a, vec2 b) { return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }

// a times -i (forward, sign 1) or i (inverse, sign -1).
vec2 quarter_turn(vec2 a, float sign) { return vec2(a.y, -a.x) * sign; }

void fft4(inout vec2 a, inout vec2 b, inout vec2 c, inout vec2 d, float sign) {
    const vec2 s = a + c, t = a - c, u = b + d, v = quarter_turn(b - d, sign);
    a = s + u;
    b = t + v;
    c = s - u;
    d = t - v;
}

void fft8(inout vec2 v[8], float sign) {
    vec2 e0 = v[0], e1 = v[2], e2 = v[4], e3 = v[6];
    vec2 o0 = v[1], o1 = v[3], o2 = v[5], o3 = v[7];
    fft4(e0, e1, e2, e3, sign);
    fft4(o0, o1, o2, o3, sign);
    const float half_root = 0.70710678118654752;
    o1 = (o1 + quarter_turn(o1, sign)) * half_root;
    o2 = quarter_turn(o2, sign);
    o3 = (quarter_turn(o3, sign) - o3) * half_root;
    v[0] = e0 + o0;
    v[1] = e1 + o1;
    v[2] = e2 + o2;
    v[3] = e3 + o3;
    v[4] = e0 - o0;
    v[5] = e1 - o1;
    v[6] = e2 - o2;
    v[7] = e3 - o3;
}

vec2 fft_turn(vec2 value, uint n, float sign) {
    const vec2 w = twiddle[n];
    return complex_product(value, vec2(w.x, w.y * sign));
}

// The last factor of the size: 8, 4, 2 or 1, in place.
void fft_last(inout vec2 v[8], float sign) {
    if (fft_n == 512) fft8(v, sign);
    if (fft_n == 256)
        for (uint k = 0; k < 2; ++k) {
            vec2 a = v[k], b = v[k + 2], c = v[k + 4], d = v[k + 6];
            fft4(a, b, c, d, sign);
            v[k] = a;
            v[k + 2] = b;
            v[k + 4] = c;
            v[k + 6] = d;
        }
    if (fft_n == 128)
        for (uint k = 0; k < 4; ++k) {
            const vec2 a = v[k], b = v[k + 4];
            v[k] = a + b;
            v[k + 4] = a - b;
        }
}

// In: v[r] = value j + r fft_n / 8 of the line. Out: v[r] = its transform there. sign 1 forward, -1 inverse (not divided by fft_n).
// All invocations of the workgroup must call this.
void fft_line(inout vec2 v[8], uint j, uint line, float sign) {
    const uint threads = fft_n / 8, radix = fft_n / 64;
    fft8(v, sign);
    barrier();
    for (uint r = 0; r < 8; ++r) fft_exchange[fft_place(line, j * 8 + r)] = v[r];
    barrier();
    for (uint r = 0; r < 8; ++r) v[r] = fft_exchange[fft_place(line, j + threads * r)];
    for (uint r = 1; r < 8; ++r) v[r] = fft_turn(v[r], 8 * r * (j & 7), sign);
    fft8(v, sign);
    if (radix == 1) return;
    barrier();
    for (uint r = 0; r < 8; ++r) fft_exchange[fft_place(line, (j >> 3) * 64 + (j & 7) + 8 * r)] = v[r];
    barrier();
    for (uint r = 0; r < 8; ++r) v[r] = fft_exchange[fft_place(line, j + threads * r)];
    // Value m belongs to butterfly k = m mod (8 / radix) as its r-th.
    for (uint m = 8 / radix; m < 8; ++m) v[m] = fft_turn(v[m], m / (8 / radix) * (j + threads * (m % (8 / radix))) * (glare_n / fft_n), sign);
    fft_last(v, sign);
}

#endif
