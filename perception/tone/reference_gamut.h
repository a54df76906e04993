// For references of tone maps: luminance, and a colour brought to a displayed luminance within the gamut, by bisection.
#pragma once

#include <algorithm>

namespace entoptic::perception {

inline double reference_luminance(const double* pixel) { return 0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2]; }

// Sets a pixel of luminance y to luminance t (cd/m²), keeping ratios, as saturated as channels up to `white` allow.
inline void show_in_gamut(double* pixel, double y, double t, double white) {
    double scaled[3];
    for (int c = 0; c < 3; ++c) scaled[c] = y > 0 ? pixel[c] * (t / y) : 0;
    const double grey = std::min(t, white);
    const auto fits = [&](double s) { return std::all_of(scaled, scaled + 3, [&](double c) { return grey + s * (c - grey) <= white; }); };
    double low = 0, high = 1;
    const bool whole = std::all_of(scaled, scaled + 3, [&](double c) { return c <= white; });
    for (int i = 0; i < 60 && !whole; ++i) (fits(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
    for (int c = 0; c < 3; ++c) pixel[c] = whole ? scaled[c] : grey + low * (scaled[c] - grey);
}

}  // namespace entoptic::perception
