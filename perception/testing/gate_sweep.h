// For tests: scenes on both sides of a gate's bound, and the count of what the gate said. Header-only.
#pragma once

#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <vector>

namespace entoptic::perception::testing {

// `count` factors of a bound in ascending order: a quarter of them evenly within 20 % of it, the others evenly in log10 from 10^-decades to
// 10^decades. None is closer to the bound than `nearest`, where rounding decides.
inline std::vector<double> factors_around_bound(int count = 120, double decades = 5, double nearest = 0.005) {
    const int close = (count + 3) / 4, half = close / 2 + close % 2, far = (count - 2 * half) / 2;
    const auto between = [](double from, double to, int i, int n) { return from + (to - from) * (i + 0.5) / n; };
    std::vector<double> factors;
    for (int i = 0; i < far; ++i) factors.push_back(std::pow(10, between(-decades, std::log10(0.8), i, far)));
    for (int i = 0; i < half; ++i) factors.push_back(between(0.8, 1 - nearest, i, half));
    for (int i = 0; i < half; ++i) factors.push_back(between(1 + nearest, 1.2, i, half));
    for (int i = 0; i < far; ++i) factors.push_back(std::pow(10, between(std::log10(1.2), decades, i, far)));
    return factors;
}

// The largest luminance (cd/m²) between two for which `acts` holds, when it holds below a bound only.
template <class Acts> double largest_luminance(double low, double high, Acts acts) {
    while (high / low > 1 + 1e-6) {
        const double middle = std::sqrt(low * high);
        (acts(middle) ? low : high) = middle;
    }
    return low;
}

struct GateCount {
    int ran = 0, gated = 0, near_bound = 0;

    // `factor`: what drives the gate over its bound.
    void add(bool is_gated, double factor) {
        (is_gated ? gated : ran)++;
        near_bound += std::abs(factor - 1) <= 0.2;
    }
    // At least `scenes` were seen, a quarter of them near the bound, and a third of them each way.
    void expect_both_outcomes(int scenes = 100) const {
        std::printf("gate: ran %d, gated %d, near the bound %d\n", ran, gated, near_bound);
        EXPECT_GE(ran + gated, scenes);
        EXPECT_GE(3 * ran, ran + gated);
        EXPECT_GE(3 * gated, ran + gated);
        EXPECT_GE(4 * near_bound, ran + gated);
    }
};

}  // namespace entoptic::perception::testing
