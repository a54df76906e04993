// luidolt_spectral in double from the definition, with none of the shader's code: see glare_reference.h. The pupil's diffraction comes from
// Rayleigh's encircled energy 1 - J0^2 - J1^2 over rings, the particles' from Bessel functions of the standard library. The halo is the
// expected one (no speckle).
#include "perception/glare/glare.h"
#include "perception/glare/glare_reference.h"
#include "perception/glare/luidolt_spectral_params.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

namespace entoptic::perception {
namespace {

using glare_reference::Kernel;
using glare_reference::Rgb;
using glare_reference::Scatter;
using glare_reference::Wave;

constexpr double pi = 3.14159265358979323846;

bool printed(const LuidoltSpectralParams& p) { return p.as_printed > 0.5f; }

// Eq. 9 and 10 to the letter, or midpoints with each channel of sum 1.
std::vector<Wave> spectrum(const LuidoltSpectralParams& p) {
    if (!printed(p)) return glare_reference::white_spectrum();
    const int k = static_cast<int>(std::lround(p.wavelengths));
    std::vector<Wave> waves;
    double sum = 0;
    for (int i = 0; i <= k; ++i) {
        const double nm = 380 + i * 390.0 / k;
        Rgb rgb = glare_reference::linear_rgb(nm);
        for (double& value : rgb) sum += value *= nm * nm / (575.0 * 575.0);
        waves.push_back({nm, rgb});
    }
    for (Wave& wave : waves)
        for (double& value : wave.weight) value /= sum / 3;
    return waves;
}

// The kernel of one eye, and its energy by channel.
struct EyeKernel {
    Kernel per_sr;
    Rgb gain;
};

EyeKernel make_kernel(const LuidoltSpectralParams& p, double pupil_mm, double pixel_rad) {
    const std::vector<Wave> waves = spectrum(p);
    const double density = printed(p) ? 1000 / (pi / 4 * pupil_mm * pupil_mm) : static_cast<double>(p.particles_per_mm2);
    const double a_um = static_cast<double>(p.particle_diameter_um), f = 1 - std::exp(-density * pi / 4 * a_um * a_um * 1e-6);
    const double scale = static_cast<double>(p.angle_scale), end = static_cast<double>(p.radius_deg) * pi / 180;
    const auto whole = [&](double theta) {
        const double inner = std::min(theta / scale, pi / 2), t = std::clamp((end - theta) / (0.1 * end), 0.0, 1.0);
        Rgb sum{};
        for (const Wave& wave : waves) {
            const double pupil = (1 - f) * static_cast<double>(p.diffraction) * glare_reference::aperture_ring(pupil_mm * 1e3, wave.nm * 1e-3, inner, pixel_rad / 8);
            const double particles = f * glare_reference::disc(a_um, wave.nm * 1e-3, inner);
            for (std::size_t c = 0; c < 3; ++c) sum[c] += wave.weight[c] * (pupil + particles);
        }
        for (double& value : sum) value = std::max(value, 0.0) * t * t * (3 - 2 * t) * static_cast<double>(p.strength) / (scale * scale);
        return sum;
    };
    Rgb gain{};
    for (const Wave& wave : waves)
        for (std::size_t c = 0; c < 3; ++c) gain[c] += wave.weight[c];
    return {Kernel(whole), gain};
}

class LuidoltSpectralReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> parameters) override {
        LuidoltSpectralParams p;
        std::memcpy(&p, parameters.data(), sizeof p);
        const Scatter scatter(frame.geometry);
        const EyeKernel& kernel = kernel_of(p, static_cast<double>(frame.eye.pupil_diameter_mm), scatter.smallest_step());
        const ImageD scattered = scatter(frame.image, kernel.per_sr, true);
        const double sigma = (printed(p) && p.window_sigma_deg <= 0 ? 10.0 : static_cast<double>(p.window_sigma_deg)) * pi / 180;
        for (int y = 0; y < frame.image.height; ++y)
            for (int x = 0; x < frame.image.width; ++x) {
                if (!scatter.visible(x, y)) continue;
                const double away = std::acos(std::clamp(glm::dot(glm::dvec3(frame.eye.gaze_direction), scatter.direction(x, y)), -1.0, 1.0));
                const double window = sigma > 0 ? std::exp(-0.5 * std::pow(away / sigma, 2)) : 1;
                for (int c = 0; c < 3; ++c) {
                    double& value = frame.image.at(x, y, c);
                    value += window * ((kernel.gain[static_cast<std::size_t>(c)] - 1) * value + scattered.at(x, y, c));
                }
            }
    }

private:
    // The table takes seconds; the last one is kept.
    const EyeKernel& kernel_of(const LuidoltSpectralParams& p, double pupil_mm, double pixel_rad) {
        const std::array<double, 2> key{pupil_mm, pixel_rad};
        if (!kernel_ || std::memcmp(&p, &kept_params_, sizeof p) != 0 || key != kept_key_) kernel_ = make_kernel(p, pupil_mm, pixel_rad);
        kept_params_ = p;
        kept_key_ = key;
        return *kernel_;
    }

    std::optional<EyeKernel> kernel_;
    LuidoltSpectralParams kept_params_{};
    std::array<double, 2> kept_key_{};
};

}  // namespace

std::unique_ptr<ReferenceModel> make_luidolt_spectral_reference() { return std::make_unique<LuidoltSpectralReference>(); }

}  // namespace entoptic::perception
