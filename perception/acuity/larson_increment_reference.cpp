// larson_increment in double from the paper: acuity by the printed formula, the blur by local_blur_reference.cpp.
#include "perception/acuity/local_blur.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

// Arc minutes; equation 11 of Luidolt 2020.
double sigma(double y) {
    const double cycles_per_degree = 17.25 * std::atan(1.4 * std::log10(std::max(y, 1e-8)) + 0.35) + 25.72;
    return 60 / (1.86 * std::sqrt(2.0) * cycles_per_degree);
}

class LarsonIncrementReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto value = [&](std::size_t i) { return static_cast<double>(values[i]); };
        if (frame.dt_s > 0) ticks_ += frame.dt_s * value(5);
        LocalBlurLaw law;
        law.local_mean_deg = value(2);
        law.cell_deg = value(4);
        law.ticks = ticks_;
        law.noisy = value(3) > 0;
        law.added_variance = [&](double scene, double panel, double noise, double, double ppd) {
            const double shift = std::pow(10, 3 * value(3) * noise), pixel = 60 / ppd;
            const double wearer = value(1) > 0.5 ? 0 : std::pow(sigma(panel * shift), 2);
            return std::pow(value(0), 2) * std::max(0.0, std::pow(sigma(scene * shift), 2) - wearer - pixel * pixel / 12);
        };
        apply_local_blur(frame, law);
    }

private:
    double ticks_ = 0;
};

}  // namespace

std::unique_ptr<ReferenceModel> make_larson_increment_reference() { return std::make_unique<LarsonIncrementReference>(); }

}  // namespace entoptic::perception
