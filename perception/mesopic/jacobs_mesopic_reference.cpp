// jacobs_mesopic in double from the paper, with none of the shader's code: equation 13 by log10, local means by their definition.
#include "perception/mesopic/rod_vision.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

class JacobsMesopicReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto value = [&](std::size_t i) { return static_cast<double>(values[i]); };
        constexpr double upper[] = {5, 1, 10}, lower[] = {0.005, 0.01, 0.001};   // cd/m²
        const auto range = static_cast<std::size_t>(std::lround(value(2)));
        RodVisionLaw law;
        law.scotopic = glm::dvec3(0, 0.8451, 0.1459) / (0.8451 + 0.1459);
        law.tint = {value(4), value(5), value(6)};
        law.strength = value(0);
        law.photographic = value(1) > 0.5;
        law.local_mean_deg = value(3);
        law.cone_share = [m1 = std::log10(upper[range]), m2 = std::log10(lower[range])](double y) {
            return std::clamp((std::log10(y) - m2) / (m1 - m2), 0.0, 1.0);
        };
        apply_rod_vision(frame, law);
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_jacobs_mesopic_reference() { return std::make_unique<JacobsMesopicReference>(); }

}  // namespace entoptic::perception
