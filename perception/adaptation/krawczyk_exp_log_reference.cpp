// krawczyk_exp_log in double: equation 2 of Luidolt et al. 2020 on log10 luminance.
#include "perception/adaptation/adaptation.h"
#include "perception/adaptation/reference_target.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

class KrawczykExpLogReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto parameter = [&](std::size_t i) { return static_cast<double>(values[i]); };
        const double floor = parameter(2);
        const auto target = target_to_approach(frame, reference_target(frame, {parameter(0), parameter(1), parameter(3), parameter(4) > 0.5}), floor);
        if (!target) return;
        const double rod = 0.04 / (0.04 + *target), tau = rod * parameter(6) + (1 - rod) * parameter(7);
        const double share = -std::expm1(-frame.dt_s * parameter(5) / tau);
        frame.adaptation_cd_m2 = std::max(floor, std::pow(10, (1 - share) * std::log10(frame.adaptation_cd_m2) + share * std::log10(*target)));
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_krawczyk_exp_log_reference() { return std::make_unique<KrawczykExpLogReference>(); }

}  // namespace entoptic::perception
