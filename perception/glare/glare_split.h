// The split of a round kernel into a far part, smooth enough for the coarse grid, and a near part, which is summed pixel by pixel: what is left.
// Inside `near` the far part is the even polynomial of the angle that meets the kernel there with its value and three derivatives, so that neither
// part has an edge anywhere. (Particle-mesh methods split forces so: Hockney and Eastwood 1988, chapter 8; the cap by the kernel's own derivatives is
// ours, since K falls as theta^-3 here and as theta^-2 there.) Where that is no cap, since the kernel does not fall evenly there, or its near part is
// not summed, the far part is K times a share that goes smoothly to 0 at the centre: near_share() of glare_math.glsl.
#pragma once

#include "perception/glare/glare_gpu.h"
#include "perception/glare/glare_math.glsl"

#include <array>
#include <cmath>
#include <functional>
#include <glm/glm.hpp>

namespace entoptic::perception {

// Width of a cap that the grid can carry.
constexpr double least_cap_texels = 2.5;

class FarPart {
public:
    // `per_sr` at angles in rad, from 0.8 to 1.2 `near_rad`. `capped`: near_rad is the reach() of the whole kernel;
    // false if that is 0, or if the near part is not drawn.
    FarPart(const std::function<glm::dvec3(double theta)>& per_sr, double near_rad, bool capped) : near_rad_(near_rad), capped_(capped) {
        if (capped) fit(per_sr);
    }
    // Of a kernel whose value at theta (rad) is `whole`.
    glm::dvec3 operator()(double theta, glm::dvec3 whole) const {
        if (theta >= near_rad_) return whole;
        if (!capped_) return whole * (1 - glare::near_share(theta, near_rad_));
        const double q = theta * theta / (near_rad_ * near_rad_);
        return coefficients_[0] + q * (coefficients_[1] + q * (coefficients_[2] + q * coefficients_[3]));
    }
    // The widest near field of at most `wanted_rad` whose cap is one; 0 if there is none down to half of that. Of pictures with few pixels a degree it
    // ends at 3 degrees, or 2.5 texels: the rings of halos lie beyond, which one kernel a tile cannot carry.
    static double reach(const std::function<glm::dvec3(double theta)>& per_sr, double wanted_rad, double pitch) {
        const double most = std::min(wanted_rad, std::max(3 * 3.141592653589793 / 180, least_cap_texels * pitch));
        for (double near = most; near > 0.5 * most; near *= 0.85)
            if (falls_evenly(per_sr, near)) return near;
        return 0;
    }

private:
    // The even polynomial is not negative, and not above the kernel by more than 5 % (a level kernel is its own cap, to a few per cent).
    static bool falls_evenly(const std::function<glm::dvec3(double theta)>& per_sr, double near_rad) {
        const FarPart far(per_sr, near_rad, true);
        bool even = true;
        for (int i = 1; i < 32; ++i) {
            const double theta = near_rad * i / 32;
            const glm::dvec3 whole = per_sr(theta), cap = far(theta, whole);
            for (int c = 0; c < 3; ++c) even = even && cap[c] >= 0 && cap[c] <= 1.05 * whole[c];
        }
        return even;
    }
    void fit(const std::function<glm::dvec3(double theta)>& per_sr) {
        // Central differences of sixth, of the third derivative fourth order, over the logarithm of the angle, in whole steps of a radial table, where
        // its interpolation is off by the same factor everywhere; from them the derivatives over the angle in units of near_rad.
        static const double step = 20 * std::log(3.141592653589793 / static_cast<double>(radial_first)) / (radial_entries - 1);
        std::array<glm::dvec3, 7> at;
        for (int i = -3; i <= 3; ++i) at[static_cast<std::size_t>(i + 3)] = per_sr(near_rad_ * std::exp(step * i));
        const auto odd = [&](std::size_t i) { return at[3 + i] - at[3 - i]; };
        const auto even = [&](std::size_t i) { return at[3 + i] + at[3 - i]; };
        const glm::dvec3 log_first = (odd(1) * 45.0 - odd(2) * 9.0 + odd(3)) / (60 * step);
        const glm::dvec3 log_second = (even(1) * 270.0 - even(2) * 27.0 + even(3) * 2.0 - at[3] * 490.0) / (180 * step * step);
        const glm::dvec3 log_third = (odd(1) * -13.0 + odd(2) * 8.0 - odd(3)) / (8 * step * step * step);
        const glm::dvec3 second = log_second - log_first, third = log_third - 3.0 * log_second + 2.0 * log_first;
        // a0 + a1 q + a2 q^2 + a3 q^3 with q = (theta / near)^2.
        const glm::dvec3 difference = second - log_first;
        coefficients_[3] = (third - 3.0 * difference) / 48.0;
        coefficients_[2] = (difference - 24.0 * coefficients_[3]) / 8.0;
        coefficients_[1] = (log_first - 4.0 * coefficients_[2] - 6.0 * coefficients_[3]) / 2.0;
        coefficients_[0] = at[3] - coefficients_[1] - coefficients_[2] - coefficients_[3];
    }
    double near_rad_;
    bool capped_;
    std::array<glm::dvec3, 4> coefficients_{};
};

// How a kernel is sharpened on a grid of texels `pitch` wide (rad), whose splines make sinc(f)^splines: exponent and order of sharpening(). `smooth`: beyond the
// near field it has no detail as fine as a texel. The mean over a texel is undone, too. What is no such kernel or no wide cap holds frequencies that the
// grid cannot carry: sharpened in full they would ring.
struct Sharpening {
    double damping;
    unsigned order;
};
constexpr Sharpening sharpening_for(double near_rad, double pitch, double splines, bool capped, bool smooth) {
    if (capped && smooth && near_rad >= least_cap_texels * pitch) return {splines + 1, glare::most_sharpening};
    return {splines, 3};
}

}  // namespace entoptic::perception
