// Sum over the spectrum of the table: count, direct and covered share; then of each wavelength um, weight, and what straylight is multiplied by. Include
// after curve_pass.glsl.
const uint table_head = 3u, table_row = 3u;

float sum_of_waves(WaveOptics w, float deg, float straylight_per_sr) {
    const float sine = sin(radians(deg));
    float sum = 0.0;
    w.direct = table[1];
    w.covered = table[2];
    for (uint i = 0u; i < uint(table[0]); ++i) {
        const uint at = table_head + table_row * i;
        sum += table[at + 1] * (direct_light(w, table[at], sine) + scattered_light(w, table[at], sine, deg) + table[at + 2] * straylight_per_sr);
    }
    return sum;
}
