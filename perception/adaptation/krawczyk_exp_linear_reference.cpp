// krawczyk_exp_linear in double from the paper's equations, with none of the shader's code; equation 2 uses the C library's expm1.
#include "perception/adaptation/adaptation.h"
#include "perception/adaptation/reference_target.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

class KrawczykExpLinearReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto parameter = [&](std::size_t i) { return static_cast<double>(values[i]); };
        const auto target = target_to_approach(frame,
                                               parameter(7) > 0.5 ? reference_target_as_printed(frame, parameter(0))
                                                                  : reference_target(frame, {parameter(0), parameter(1), parameter(6), false}),
                                               parameter(5));
        if (!target) return;
        const double rod = 0.04 / (0.04 + *target);
        const double tau = rod * parameter(2) + (1 - rod) * parameter(3);
        frame.adaptation_cd_m2 += (*target - frame.adaptation_cd_m2) * -std::expm1(-frame.dt_s * parameter(4) / tau);
        frame.adaptation_cd_m2 = std::max(frame.adaptation_cd_m2, parameter(5));
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_krawczyk_exp_linear_reference() { return std::make_unique<KrawczykExpLinearReference>(); }

}  // namespace entoptic::perception
