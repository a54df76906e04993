// jacobs_ramp in double: equation 3 of Jacobs et al. 2015.
#include "perception/adaptation/adaptation.h"
#include "perception/adaptation/reference_target.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

class JacobsRampReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto parameter = [&](std::size_t i) { return static_cast<double>(values[i]); };
        const double floor = parameter(2);
        const auto target = target_to_approach(frame, reference_target(frame, {parameter(0), parameter(1), parameter(3), parameter(4) > 0.5}), floor);
        if (!target) return;
        const double now = std::log10(frame.adaptation_cd_m2), end = std::log10(*target), dt = frame.dt_s * parameter(5);
        const double next = now < end ? std::min(end, now + parameter(6) * dt) : std::max(end, now - parameter(7) * dt);
        frame.adaptation_cd_m2 = std::max(floor, std::pow(10, next));
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_jacobs_ramp_reference() { return std::make_unique<JacobsRampReference>(); }

}  // namespace entoptic::perception
