// rod_noise in double from physics: quanta counted from the energy of a photon, with none of the shader's code.
#include "perception/noise/noise.h"
#include "perception/patch_noise_reference.h"

#include "shaders/geometry.glsl"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace entoptic::perception {
namespace {

constexpr double planck = 6.62607015e-34, light_m_s = 299792458;  // SI, exact
constexpr double scotopic_lm_w = 1700.06;                         // CIE 1951, at 507 nm

// Quanta of 507 nm per second that enter the eye from a square of `side_deg` of luminance `scotopic` (cd/m²).
double quanta_per_s(double scotopic, double pupil_mm, double side_deg) {
    const double side_rad = side_deg * std::numbers::pi / 180, pupil_m2 = std::numbers::pi / 4 * std::pow(pupil_mm * 1e-3, 2);
    const double lumen = scotopic * pupil_m2 * side_rad * side_rad;
    return lumen / scotopic_lm_w / (planck * light_m_s / 507e-9);
}

class RodNoiseReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto parameter = [&](std::size_t i) { return static_cast<double>(values[i]); };
        if (frame.dt_s > 0) ticks_ += frame.dt_s / parameter(4);
        const double a = frame.adaptation_cd_m2;
        const double t = std::clamp(std::log10(0.1 / a) / std::log10(0.1 / 0.03), 0.0, 1.0), dim = parameter(0) * t * t * (3 - 2 * t);
        const auto variance = [&](double y) {  // of the count over its square
            return 1 / (quanta_per_s(parameter(2) * y, static_cast<double>(frame.eye.pupil_diameter_mm), parameter(3)) * parameter(4) *
                        parameter(5));
        };
        for (int y = 0; y < frame.image.height; ++y)
            for (int x = 0; x < frame.image.width; ++x) {
                if (!geometry::geometry_visible(frame.geometry, {x + 0.5, y + 0.5})) continue;
                double* pixel = &frame.image.at(x, y, 0);
                const double scene = std::max(0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2], 1e-6);
                const double panel =
                    frame.displayed ? frame.displayed(scene) : std::min(scene, static_cast<double>(frame.display.white_cd_m2));
                const double lift = std::max(1.0, static_cast<double>(frame.display.black_cd_m2) / panel);
                const double added = parameter(1) < 0.5 ? variance(scene * lift) - variance(panel * lift) : variance(scene);
                if (!(added > 0) || dim == 0) continue;
                const double sigma = std::sqrt(std::log1p(dim * dim * added));
                const double normal =
                    patch_noise_reference(frame, geometry::geometry_direction(frame.geometry, {x + 0.5, y + 0.5}), parameter(3), ticks_);
                for (int c = 0; c < 3; ++c) pixel[c] *= std::exp(sigma * normal - sigma * sigma / 2);
            }
    }

private:
    double ticks_ = 0;
};

}  // namespace

std::unique_ptr<ReferenceModel> make_rod_noise_reference() { return std::make_unique<RodNoiseReference>(); }

}  // namespace entoptic::perception
