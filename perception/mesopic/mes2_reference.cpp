// mes2 in double from CIE 191, with none of the shader's code: the adaptation coefficient by a search for the change of sign on a fine
// scale and bisection inside it, local means by their definition.
#include "perception/mesopic/rod_vision.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

constexpr double v_prime_555 = 683.0 / 1700;

// By how much m is above the coefficient of its own mesopic luminance.
double excess(double m, double photopic, double scotopic) {
    const double mesopic = (m * photopic + (1 - m) * scotopic * v_prime_555) / (m + (1 - m) * v_prime_555);
    return m - std::clamp(1 + std::log10(mesopic / 5) / 3, 0.0, 1.0);
}

double adaptation_coefficient(double photopic, double scotopic) {
    if (photopic >= 5) return 1;
    double low = 0;
    if (excess(low, photopic, scotopic) >= 0) return 0;
    for (int i = 1; i <= 64; ++i) {
        double high = i / 64.0;
        if (excess(high, photopic, scotopic) < 0) {
            low = high;
            continue;
        }
        for (int k = 0; k < 50; ++k) {
            const double middle = 0.5 * (low + high);
            (excess(middle, photopic, scotopic) < 0 ? low : high) = middle;
        }
        return high;
    }
    return 1;
}

class Mes2Reference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto value = [&](std::size_t i) { return static_cast<double>(values[i]); };
        RodVisionLaw law;
        law.scotopic = {0.0153, 0.5951, 0.3896};
        law.gain = 2.4645 * v_prime_555;
        law.rod_lumen = v_prime_555;
        law.tint = {value(4), value(5), value(6)};
        law.strength = value(0);
        law.photographic = value(1) > 0.5;
        law.local_mean_deg = value(3);
        law.cone_share = [sp = value(2)](double y) { return adaptation_coefficient(y, sp * y); };
        apply_rod_vision(frame, law);
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_mes2_reference() { return std::make_unique<Mes2Reference>(); }

}  // namespace entoptic::perception
