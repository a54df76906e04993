// luidolt_spectral in double from the definition, with none of the shader's code: every pixel gets light from every other pixel, each pair by
// its true angle on the sphere. No grid, no transform, no projection. The pupil's diffraction comes from Rayleigh's encircled energy
// 1 - J0^2 - J1^2 over rings, the particles' from Bessel functions of the standard library. The halo is the expected one (no speckle).
// Time grows with the square of the pixels: for pictures of some thousands.
#include "perception/glare/glare.h"
#include "perception/glare/luidolt_spectral_params.h"

#include "shaders/geometry.glsl"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace entoptic::perception {
namespace {

constexpr double pi = 3.14159265358979323846;

using Rgb = std::array<double, 3>;

struct Wave {
    double nm;
    Rgb weight;
};

// Wyman, Sloan and Shirley 2013, multi-lobe fit of the CIE 1931 functions.
double lobe(double a, double nm, double m, double s1, double s2) { return a * std::exp(-0.5 * std::pow((nm - m) / (nm < m ? s1 : s2), 2)); }

Rgb linear_rgb(double nm) {
    const double x = lobe(1.056, nm, 599.8, 37.9, 31.0) + lobe(0.362, nm, 442.0, 16.0, 26.7) - lobe(0.065, nm, 501.1, 20.4, 26.2);
    const double y = lobe(0.821, nm, 568.8, 46.9, 40.5) + lobe(0.286, nm, 530.9, 16.3, 31.1);
    const double z = lobe(1.217, nm, 437.0, 11.8, 36.0) + lobe(0.681, nm, 459.0, 26.0, 13.8);
    return {3.2404542 * x - 1.5371385 * y - 0.4985314 * z, -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
            0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
}

std::vector<Wave> spectrum(const LuidoltSpectralParams& p) {
    const bool printed = p.as_printed > 0.5f;
    const int k = printed ? static_cast<int>(std::lround(p.wavelengths)) : 75;      // every 4 nm
    std::vector<Wave> waves;
    Rgb sum{};
    for (int i = 0; i < (printed ? k + 1 : k); ++i) {
        const double nm = printed ? 380 + i * 390.0 / k : 400 + (i + 0.5) * 300.0 / k;
        Rgb rgb = linear_rgb(nm);
        for (int c = 0; c < 3; ++c) {
            if (printed) rgb[c] *= nm * nm / (575.0 * 575.0);
            sum[c] += rgb[c];
        }
        waves.push_back({nm, rgb});
    }
    for (Wave& wave : waves)
        for (int c = 0; c < 3; ++c) wave.weight[c] /= printed ? (sum[0] + sum[1] + sum[2]) / 3 : sum[c];
    return waves;
}

// The kernel per sr as a function of the angle, tabulated evenly in its logarithm.
class Kernel {
public:
    Kernel(const LuidoltSpectralParams& p, double pupil_mm, double pixel_rad) {
        const std::vector<Wave> waves = spectrum(p);
        const bool printed = p.as_printed > 0.5f;
        const double density = printed ? 1000 / (pi / 4 * pupil_mm * pupil_mm) : static_cast<double>(p.particles_per_mm2);
        const double a_um = static_cast<double>(p.particle_diameter_um), f = 1 - std::exp(-density * pi / 4 * a_um * a_um * 1e-6);
        const double scale = static_cast<double>(p.angle_scale);
        for (const Wave& wave : waves)
            for (int c = 0; c < 3; ++c) gain_[c] += wave.weight[c];
        for (int i = 0; i < entries; ++i) {
            const double theta = angle_of(i), inner = std::min(theta / scale, pi / 2);
            Rgb sum{};
            for (const Wave& wave : waves)
                for (int c = 0; c < 3; ++c)
                    sum[c] += wave.weight[c] * ((1 - f) * static_cast<double>(p.diffraction) * ring_mean(pupil_mm * 1e3, wave.nm * 1e-3, inner, pixel_rad / 8) +
                                                f * disc(a_um, wave.nm * 1e-3, inner));
            const double end = static_cast<double>(p.radius_deg) * pi / 180, t = std::clamp((end - theta) / (0.1 * end), 0.0, 1.0);
            for (int c = 0; c < 3; ++c)
                table_[c].push_back(std::max(sum[c], 0.0) * t * t * (3 - 2 * t) * static_cast<double>(p.strength) / (scale * scale));
        }
    }
    Rgb operator()(double theta) const {
        const double place = std::clamp(std::log(std::max(theta, 1e-12) / first) / std::log(last / first) * (entries - 1), 0.0, entries - 1.001);
        const auto i = static_cast<std::size_t>(place);
        const double t = place - static_cast<double>(i);
        Rgb value;
        for (int c = 0; c < 3; ++c) value[c] = table_[c][i] * (1 - t) + table_[c][i + 1] * t;
        return value;
    }
    const Rgb& gain() const { return gain_; }

private:
    static constexpr int entries = 3072;
    static constexpr double first = 2e-4, last = pi;
    static double angle_of(int i) { return first * std::pow(last / first, static_cast<double>(i) / (entries - 1)); }

    // Encircled energy of the Airy pattern (Rayleigh 1881).
    static double encircled(double x) { return 1 - std::pow(std::cyl_bessel_j(0.0, x), 2) - std::pow(std::cyl_bessel_j(1.0, x), 2); }
    // Mean over a ring wide enough to hold whole fringes. Beyond x = 200 the fringes' mean 2/(pi x) of 1 - E is exact to 1e-5.
    static double ring_mean(double pupil_um, double lambda_um, double theta, double least) {
        const double half = std::max(least, lambda_um / pupil_um), inside = std::max(theta - half, 0.0), outside = std::min(theta + half, pi / 2);
        const auto outside_energy = [&](double angle) {
            const double x = pi * pupil_um * std::sin(angle) / lambda_um;
            return x > 200 ? 2 / (pi * x) : 1 - encircled(x);
        };
        if (outside <= inside + 1e-9) return lambda_um / (pi * pi * pi * pupil_um);
        // Energy is counted per angle^2 as on the plane of sin(theta): d(omega) = 2 pi sin cos dtheta there.
        return (outside_energy(inside) - outside_energy(outside)) / (pi * (std::pow(std::sin(outside), 2) - std::pow(std::sin(inside), 2)));
    }
    static double disc(double d_um, double lambda_um, double theta) {
        const double x = pi * d_um * std::sin(theta) / lambda_um, peak = pi / 4 * d_um * d_um / (lambda_um * lambda_um);
        return x < 1e-6 ? peak : peak * std::pow(2 * std::cyl_bessel_j(1.0, x) / x, 2);
    }

    std::array<std::vector<double>, 3> table_;
    Rgb gain_{};
};

// Share of the near field in the kernel: what theta^-3 has above the even polynomial that meets it at `near` with two derivatives.
double near_part(double theta, double near) {
    if (theta >= near) return 0;
    const double t = theta / near;
    return 1 - 4.375 * std::pow(t, 3) + 5.25 * std::pow(t, 5) - 1.875 * std::pow(t, 7);
}

class LuidoltSpectralReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> parameters) override {
        LuidoltSpectralParams p;
        std::memcpy(&p, parameters.data(), sizeof p);
        frame_ = &frame;
        width_ = frame.image.width;
        height_ = frame.image.height;
        printed_ = p.as_printed > 0.5f;
        measure();
        const Kernel& kernel = kernel_of(p, static_cast<double>(frame.eye.pupil_diameter_mm), smallest_step_);
        near_ = std::floor(static_cast<double>(p.near_px)) * mean_step_;
        threshold_ = printed_ ? 0 : static_cast<double>(p.near_from) * frame.adaptation_cd_m2;
        const double sigma = (printed_ && p.window_sigma_deg <= 0 ? 10.0 : static_cast<double>(p.window_sigma_deg)) * pi / 180;
        ImageD out = frame.image;
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                if (solid_angle_[index(x, y)] <= 0) continue;
                const Rgb change = change_at(x, y, kernel);
                double window = 1;
                if (sigma > 0) {
                    const double cosine = glm::dot(glm::dvec3(frame.eye.gaze_direction), direction_[index(x, y)]);
                    window = std::exp(-0.5 * std::pow(std::acos(std::clamp(cosine, -1.0, 1.0)) / sigma, 2));
                }
                for (int c = 0; c < 3; ++c) out.at(x, y, c) += window * ((kernel.gain()[c] - 1) * frame.image.at(x, y, c) + change[c]);
            }
        frame.image = std::move(out);
    }

private:
    // The table takes seconds; the last one is kept.
    const Kernel& kernel_of(const LuidoltSpectralParams& p, double pupil_mm, double pixel_rad) {
        if (!kernel_ || std::memcmp(&p, &kernel_params_, sizeof p) != 0 || pupil_mm != kernel_pupil_mm_ || pixel_rad != kernel_pixel_rad_)
            kernel_ = std::make_unique<Kernel>(p, pupil_mm, pixel_rad);
        kernel_params_ = p;
        kernel_pupil_mm_ = pupil_mm;
        kernel_pixel_rad_ = pixel_rad;
        return *kernel_;
    }

    std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x); }

    glm::dvec3 towards(double x, double y) const { return geometry::geometry_direction(frame_->geometry, {x, y}); }

    // Directions, solid angles (two triangles a pixel) and the smallest step between pixels.
    void measure() {
        direction_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), glm::dvec3(0));
        solid_angle_.assign(direction_.size(), 0);
        smallest_step_ = 1;
        mean_step_ = 0;
        int visible = 0;
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                if (!geometry::geometry_visible(frame_->geometry, {x + 0.5, y + 0.5})) continue;
                const glm::dvec3 a = towards(x, y), b = towards(x + 1, y), c = towards(x + 1, y + 1), d = towards(x, y + 1);
                direction_[index(x, y)] = towards(x + 0.5, y + 0.5);
                solid_angle_[index(x, y)] = 0.5 * (glm::length(glm::cross(b - a, d - a)) + glm::length(glm::cross(b - c, d - c)));
                smallest_step_ = std::min({smallest_step_, glm::length(b - a), glm::length(d - a)});
                mean_step_ += std::sqrt(glm::length(b - a) * glm::length(d - a));
                ++visible;
            }
        mean_step_ /= std::max(visible, 1);
        if (frame_->geometry.kind == geometry_equirect) smallest_step_ = mean_step_ = pi / height_;
    }

    // Kernel between two pixels, integrated over the source's pixel where that matters.
    Rgb weight(int x, int y, int u, int v, const Kernel& kernel, bool near) const {
        const int apart = std::max(std::abs(u - x), std::abs(v - y)), samples = apart <= 2 ? 12 : apart <= 10 ? 4 : 1;
        const glm::dvec3 here = direction_[index(x, y)];
        Rgb sum{};
        for (int j = 0; j < samples; ++j)
            for (int i = 0; i < samples; ++i) {
                const glm::dvec3 there = samples == 1 ? direction_[index(u, v)] : towards(u + (i + 0.5) / samples, v + (j + 0.5) / samples);
                const double theta = 2 * std::asin(std::min(0.5 * glm::length(there - here), 1.0));
                const double share = near ? near_part(theta, near_) : 1 - near_part(theta, near_);
                const Rgb value = kernel(theta);
                for (int c = 0; c < 3; ++c) sum[c] += value[c] * share;
            }
        for (int c = 0; c < 3; ++c) sum[c] *= solid_angle_[index(u, v)] / (samples * samples);
        return sum;
    }

    // Sum over all other pixels of K (C(y) - C(x)); the near part counts only what is above the threshold.
    Rgb change_at(int x, int y, const Kernel& kernel) const {
        Rgb sum{};
        const ImageD& image = frame_->image;
        const double reach = near_ > 0 ? near_ : 0;
        for (int v = 0; v < height_; ++v)
            for (int u = 0; u < width_; ++u) {
                if ((u == x && v == y) || solid_angle_[index(u, v)] <= 0) continue;
                Rgb far_difference{}, near_difference{};
                bool any = false;
                for (int c = 0; c < 3; ++c) {
                    far_difference[c] = image.at(u, v, c) - image.at(x, y, c);
                    near_difference[c] = std::max(image.at(u, v, c) - threshold_, 0.0) - std::max(image.at(x, y, c) - threshold_, 0.0);
                    any = any || far_difference[c] != 0;
                }
                if (!any) continue;
                const Rgb far_weight = weight(x, y, u, v, kernel, false);
                for (int c = 0; c < 3; ++c) sum[c] += far_weight[c] * far_difference[c];
                if (glm::length(direction_[index(u, v)] - direction_[index(x, y)]) > reach + 2 * smallest_step_) continue;
                const Rgb near_weight = weight(x, y, u, v, kernel, true);
                for (int c = 0; c < 3; ++c) sum[c] += near_weight[c] * near_difference[c];
            }
        return sum;
    }

    std::unique_ptr<Kernel> kernel_;
    LuidoltSpectralParams kernel_params_{};
    double kernel_pupil_mm_ = 0, kernel_pixel_rad_ = 0;
    const ReferenceFrame* frame_ = nullptr;
    int width_ = 0, height_ = 0;
    bool printed_ = false;
    double smallest_step_ = 1, mean_step_ = 1, near_ = 0, threshold_ = 0;
    std::vector<glm::dvec3> direction_;
    std::vector<double> solid_angle_;
};

}  // namespace

std::unique_ptr<ReferenceModel> make_luidolt_spectral_reference() { return std::make_unique<LuidoltSpectralReference>(); }

}  // namespace entoptic::perception
