// Counter-based random numbers: the value depends on (seed, counter) only, so runs repeat and order does not matter.
#pragma once

#include <cmath>
#include <cstdint>

namespace entoptic {

// 64-bit mixing by SplitMix64's finaliser (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators").
constexpr std::uint64_t mix64(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

// Uniform in [0, 1).
constexpr double uniform01(std::uint64_t seed, std::uint64_t counter) {
    return static_cast<double>(mix64(seed * 0x9e3779b97f4a7c15ull ^ mix64(counter)) >> 11) * 0x1.0p-53;
}

// Standard normal by Box and Muller 1958; uses counters 2c and 2c+1.
inline double normal(std::uint64_t seed, std::uint64_t counter) {
    const double u = 1.0 - uniform01(seed, 2 * counter);
    return std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586 * uniform01(seed, 2 * counter + 1));
}

}  // namespace entoptic
