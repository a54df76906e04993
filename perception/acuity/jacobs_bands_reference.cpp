// jacobs_bands in double from the paper, with none of the shader's code: the bank's Gaussian that is left after the bands, by counting
// thresholds in log luminance; the blur by local_blur_reference.cpp.
#include "perception/acuity/local_blur.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

constexpr double upper_cd_m2[] = {5, 1, 10}, lower_cd_m2[] = {0.005, 0.01, 0.001};

// arcmin²
double lost_variance(std::size_t range, double g, double y, double noise) {
    const double decades = std::log10(upper_cd_m2[range] / lower_cd_m2[range]), below_top = std::log10(upper_cd_m2[range] / std::max(y, 1e-8)) / decades;
    const double dark = below_top - g * noise * std::clamp(2 * below_top, 0.0, 1.0), thresholds_passed = dark * 18;
    if (thresholds_passed <= 0) return 0;
    const double finest = std::pow(0.686869797, 2);
    return thresholds_passed < 1 ? thresholds_passed * finest : finest * std::pow(2, (std::min(thresholds_passed, 18.0) - 1) / 2);
}

class JacobsBandsReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto value = [&](std::size_t i) { return static_cast<double>(values[i]); };
        if (frame.dt_s > 0) ticks_ += frame.dt_s * value(6);
        const auto range = static_cast<std::size_t>(std::lround(value(2)));
        LocalBlurLaw law;
        law.local_mean_deg = value(3);
        law.cell_deg = value(5);
        law.ticks = ticks_;
        law.noisy = value(4) > 0;
        law.added_variance = [&](double scene, double panel, double noise, double eccentricity_deg, double) {
            const double wearer = value(1) > 0.5 ? 0 : lost_variance(range, value(4), panel, noise);
            const double wider = value(0) * (1 + value(7) * eccentricity_deg);
            return wider * wider * std::max(0.0, lost_variance(range, value(4), scene, noise) - wearer);
        };
        apply_local_blur(frame, law);
    }

private:
    double ticks_ = 0;
};

}  // namespace

std::unique_ptr<ReferenceModel> make_jacobs_bands_reference() { return std::make_unique<JacobsBandsReference>(); }

}  // namespace entoptic::perception
