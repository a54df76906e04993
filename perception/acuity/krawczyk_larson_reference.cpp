// krawczyk_larson in double from the paper, with none of the shader's code.
#include "perception/acuity/acuity.h"
#include "perception/acuity/lightness_reference.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

// Equation 11 in pixels, without the variance that integrating over a pixel adds.
double kernel_sigma(double y, double ppd) {
    const double cycles_per_degree = 17.25 * std::atan(1.4 * std::log10(std::max(y, 1e-8)) + 0.35) + 25.72;
    const double sigma = ppd / (1.86 * std::sqrt(2.0) * cycles_per_degree);
    return std::min(8.0, std::sqrt(std::max(0.0, sigma * sigma - 1.0 / 12)));
}

class KrawczykLarsonReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto strength = static_cast<double>(values[0]);
        blur_lightness(frame, [=](double, double y, double ppd) { return kernel_sigma(y, strength * ppd); });
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_krawczyk_larson_reference() { return std::make_unique<KrawczykLarsonReference>(); }

}  // namespace entoptic::perception
