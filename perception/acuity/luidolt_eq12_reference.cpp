// luidolt_eq12 in double from the paper, with none of the shader's code.
#include "perception/acuity/acuity.h"
#include "perception/acuity/lightness_reference.h"

#include <algorithm>

namespace entoptic::perception {
namespace {

class LuidoltEq12Reference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto strength = static_cast<double>(values[0]);
        // Equation 12 is in pixels of a display with 13.85 of them per degree.
        blur_lightness(frame,
                       [=](double lightness, double, double ppd) { return std::min(8.0, (1 - lightness) * strength * ppd / 13.85); });
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_luidolt_eq12_reference() { return std::make_unique<LuidoltEq12Reference>(); }

}  // namespace entoptic::perception
