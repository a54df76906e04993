// cie135 in double from the standard, with none of the shader's code: see glare_reference.h.
#include "perception/glare/cie135_params.h"
#include "perception/glare/glare.h"
#include "perception/glare/glare_reference.h"

#include <cmath>
#include <cstring>

namespace entoptic::perception {
namespace {

using namespace glare_reference;

constexpr double degree = 3.14159265358979323846 / 180;

// CIE 135/1-1999, eq. 8.
double total_psf(double t, double age, double p) {
    const double a = std::pow(age / 70, 4);
    return (1 - 0.08 * a) * (9.2e6 * std::pow(1 + std::pow(t / 0.0046, 2), -1.5) + 1.5e5 * std::pow(1 + std::pow(t / 0.045, 2), -1.5)) +
           (1 + 1.6 * a) * (400 / (1 + std::pow(t / 0.1, 2)) + 3e-8 * t * t + p * (1300 * std::pow(1 + std::pow(t / 0.1, 2), -1.5) + 0.8 * std::pow(1 + std::pow(t / 0.1, 2), -0.5))) +
           2.5e-3 * p;
}

class Cie135Reference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> parameters) override {
        Cie135Params p;
        std::memcpy(&p, parameters.data(), sizeof p);
        const double age = static_cast<double>(p.age), pigment = static_cast<double>(p.pigment), scale = static_cast<double>(p.angle_scale);
        const auto psf = [&](double theta) {
            const double deg = theta / degree, t = std::clamp((100 - deg) / 10, 0.0, 1.0), value = total_psf(deg, age, pigment) * t * t * (3 - 2 * t);
            return Rgb{value, value, value};
        };
        const double total = energy(psf, 1e-9, 90 * degree)[0];
        const Scatter scatter(frame.geometry);
        const auto scaled = [&](double theta) {
            const double value = static_cast<double>(p.strength) * psf(theta / scale)[0] / (total * scale * scale);
            return Rgb{value, value, value};
        };
        const double scattered = energy(scaled, 0.5 * scatter.smallest_step(), 100 * degree)[0], limit = std::min(1.0, 0.9 / scattered);
        const Kernel kernel([&](double theta) {
            Rgb value = scaled(theta);
            for (double& v : value) v *= limit;
            return value;
        });
        frame.image = seen(frame.image, scatter, kernel, kernel, false, frame.scene_white_cd_m2, static_cast<double>(p.rescatter), p.photographic > 0.5f);
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_cie135_reference() { return std::make_unique<Cie135Reference>(); }

}  // namespace entoptic::perception
