// naka_rushton in double from the equations by plain powers, with none of the shader's code; gamut mapping by bisection towards grey.
#include "perception/tone/reference_gamut.h"
#include "perception/tone/tone.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

struct Curve {
    double n, scale, plateau, display_adaptation, white, adaptation;

    double sigma(double a) const {
        const double k = std::pow(std::pow(75.57, 3), n / 3), m = plateau > 0 ? plateau : scale * std::pow(a, n / 3) / (std::pow(a, n / 3) + k);
        return a * std::pow(1 / std::clamp(m, 1e-4, 0.999) - 1, 1 / n);
    }
    double displayed(double y) const {
        const double in = std::pow(std::max(y, 1e-7), n), half = std::pow(sigma(adaptation), n), r = in / (in + half);
        if (display_adaptation <= 0) return white * r;
        return std::min(white, sigma(display_adaptation) * std::pow(r / (1 - r), 1 / n));
    }
};

Curve curve_of(const ReferenceFrame& frame, std::span<const float> v) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2]), static_cast<double>(v[3]),
            static_cast<double>(frame.display.white_cd_m2), std::max(frame.adaptation_cd_m2, 1e-6)};
}

class NakaRushtonReference final : public ReferenceModel {
public:
    void plan(ReferenceFrame& frame, std::span<const float> values) override {
        const Curve curve = curve_of(frame, values);
        frame.displayed = [curve](double y) { return curve.displayed(y); };
        frame.exposure = curve.displayed(curve.adaptation) / curve.adaptation;
        frame.scene_white_cd_m2 = curve.white / frame.exposure;
    }
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const Curve curve = curve_of(frame, values);
        for (std::size_t i = 0; i < frame.image.data.size(); i += 3) {
            const double y = reference_luminance(&frame.image.data[i]);
            show_in_gamut(&frame.image.data[i], y, curve.displayed(y), curve.white);
        }
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_naka_rushton_reference() { return std::make_unique<NakaRushtonReference>(); }

}  // namespace entoptic::perception
