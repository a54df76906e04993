// Light to codes of a measured panel, and back. Include after declaring `MeasuredPanelTable panels[2]`, one an eye.
#ifndef ENTOPTIC_COMPOSITOR_MEASURED_PANEL_GLSL
#define ENTOPTIC_COMPOSITOR_MEASURED_PANEL_GLSL

// Code, with a fraction, at which channel c sends `share` of its light: the table rises, so halving finds the step and a line the fraction.
float code_of_share(uint view, uint c, float share) {
    uint low = 0, high = 255;
    for (uint step = 0; step < 8; ++step) {
        const uint middle = (low + high) / 2;
        const bool above = panels[view].share[c * 256 + middle] > share;
        low = above ? low : middle;
        high = above ? middle : high;
    }
    const float from = panels[view].share[c * 256 + low], to = panels[view].share[c * 256 + low + 1];
    return float(low) + (share - from) / (to - from);
}

// Codes, with fractions, of light in cd/m²; light beyond what the panel can send is cut off channel by channel.
vec3 measured_codes(uint view, vec3 light) {
    vec3 codes;
    for (uint c = 0; c < 3; ++c)
        codes[c] = code_of_share(view, c, clamp(dot(panels[view].share_of_light[c], light - panels[view].black), 0.0, 1.0));
    return clamp(codes, 0.0, 255.0);
}

#endif
