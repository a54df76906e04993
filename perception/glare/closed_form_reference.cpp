// closed_form in double from the papers, with none of the shader's code: see glare_reference.h.
#include "perception/glare/closed_form_params.h"
#include "perception/glare/glare.h"
#include "perception/glare/glare_reference.h"

#include <cmath>
#include <cstring>
#include <optional>

namespace entoptic::perception {
namespace {

using namespace glare_reference;

constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180;

double smooth(double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}
double luminance(const Rgb& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

struct Eye {
    double age, pigment, factor;
};

// An eye's kernel for light of these wavelengths, per sr and of strength 1, at theta over angle_scale. How much straylight is left beside
// particles and pupil, and its norm, are those of white light.
class EyeKernel {
public:
    EyeKernel(const ClosedFormParams& p, const Eye& eye, double pupil_mm, const std::vector<Wave>& light)
        : p_(p), eye_(eye), pupil_mm_(pupil_mm), waves_(white_spectrum()) {
        covered_ = 1 - std::exp(-static_cast<double>(p.particles_per_mm2) * pi / 4 * std::pow(static_cast<double>(p.particle_diameter_um) * 1e-3, 2));
        const double norm = luminance(straylight_colour(waves_));
        colour_ = straylight_colour(light);
        for (double& c : colour_) c /= norm;
        left_ = std::max(1 - luminance(wave_optics_beyond_a_degree()) / energy([&](double t) { return Rgb{straylight(t)}; }, degree, pi)[0], 0.0);
        waves_ = light;
    }
    Rgb operator()(double theta) const {
        Rgb value = wave_optics(theta);
        for (std::size_t c = 0; c < 3; ++c) value[c] += left_ * straylight(theta) * colour_[c];
        return value;
    }

private:
    Rgb straylight_colour(const std::vector<Wave>& light) const {
        Rgb colour{};
        for (const Wave& w : light)
            for (std::size_t c = 0; c < 3; ++c)
                colour[c] += w.weight[c] * (1 + static_cast<double>(p_.straylight_colour) * (1 - std::min(eye_.pigment / 1.2, 1.0)) * (std::pow(575 / w.nm, 4) - 1));
        return colour;
    }
    // CIE 146-2002 from 0.1 to 100 degrees.
    double straylight(double theta) const {
        const double deg = std::clamp(theta / degree, 0.1, 100.0), a = 1 + std::pow(eye_.age / 62.5, 4);
        const double veil = 10 / std::pow(deg, 3) + (5 / (deg * deg) + 0.1 * eye_.pigment / deg) * a + 0.0025 * eye_.pigment;
        return veil * (1 + (eye_.factor - 1) * smooth(std::log10(deg / 0.1))) * smooth((110 - theta / degree) / 10);
    }
    Rgb wave_optics(double theta) const {
        const double inner = std::min(theta, pi / 2), fibres = std::clamp((pupil_mm_ - 1.9) / 3, 0.0, 1.0) * 0.033 * static_cast<double>(p_.lenticular_halo);
        Rgb sum{};
        for (const Wave& w : waves_) {
            const double value = (1 - covered_) * static_cast<double>(p_.diffraction) * aperture_ring(pupil_mm_ * 1e3, w.nm * 1e-3, inner, 0) +
                                 covered_ * disc(static_cast<double>(p_.particle_diameter_um), w.nm * 1e-3, inner) +
                                 fibres * 436.9 * 568 / w.nm * std::exp(-19.75 * std::pow(theta / degree - 3 * w.nm / 568, 2));
            for (std::size_t c = 0; c < 3; ++c) sum[c] += w.weight[c] * value;
        }
        return sum;
    }
    // Particles and a pupil of 4 mm take their light from the straylight. Rayleigh 1881: J0^2 + J1^2 is outside an angle; 2/(pi x) for a
    // pupil's many rings.
    Rgb wave_optics_beyond_a_degree() const {
        Rgb sum{};
        for (const Wave& w : waves_) {
            const auto x = [&](double um) { return pi * um * std::sin(degree) / (w.nm * 1e-3); };
            const double particles = x(static_cast<double>(p_.particle_diameter_um));
            const double value = covered_ * (std::pow(std::cyl_bessel_j(0.0, particles), 2) + std::pow(std::cyl_bessel_j(1.0, particles), 2)) +
                                 (1 - covered_) * static_cast<double>(p_.diffraction) * 2 / (pi * x(4000));
            for (std::size_t c = 0; c < 3; ++c) sum[c] += w.weight[c] * value;
        }
        return sum;
    }

    ClosedFormParams p_;
    Eye eye_;
    double pupil_mm_, covered_ = 0, left_ = 1;
    std::vector<Wave> waves_;
    Rgb colour_{};
};

Kernel scaled(const ClosedFormParams& p, const Kernel& one, double times) {
    const double scale = static_cast<double>(p.angle_scale);
    return Kernel([&](double theta) {
        Rgb value = one(theta / scale);
        for (double& v : value) v *= times * static_cast<double>(p.strength) / (scale * scale);
        return value;
    });
}

// A tenth of the light at least is not scattered.
Kernel make_kernel(const ClosedFormParams& p, const Eye& eye, double pupil_mm, double pixel_rad) {
    const Kernel one{EyeKernel(p, eye, pupil_mm, white_spectrum())};
    const Kernel whole = scaled(p, one, 1);
    const Rgb scattered = energy([&](double theta) { return whole(theta); }, 0.5 * pixel_rad, pi);
    return scaled(p, one, std::min(1.0, 0.9 / std::max({scattered[0], scattered[1], scattered[2]})));
}

class ClosedFormReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> parameters) override {
        ClosedFormParams p;
        std::memcpy(&p, parameters.data(), sizeof p);
        const Eye person{static_cast<double>(p.age), static_cast<double>(p.pigment), static_cast<double>(p.straylight_factor)};
        const Eye wearer{p.wearer_age > 0 ? static_cast<double>(p.wearer_age) : person.age, p.wearer_pigment >= 0 ? static_cast<double>(p.wearer_pigment) : person.pigment,
                         p.wearer_straylight_factor > 0 ? static_cast<double>(p.wearer_straylight_factor) : person.factor};
        const bool differ = person.age != wearer.age || person.pigment != wearer.pigment || person.factor != wearer.factor;
        const Scatter scatter(frame.geometry);
        const double pupil_mm = static_cast<double>(frame.eye.pupil_diameter_mm);
        const double pixel_rad = scatter.smallest_step();
        if (!person_ || std::memcmp(&p, &kept_params_, sizeof p) != 0 || pupil_mm != kept_pupil_mm_ || pixel_rad != kept_pixel_rad_) {
            person_ = make_kernel(p, person, pupil_mm, pixel_rad);
            primaries_.clear();
            for (std::size_t primary = 0; primary < 3 && p.emission_spectra > 0.5f; ++primary)
                primaries_.push_back(scaled(p, Kernel{EyeKernel(p, person, pupil_mm, primary_spectrum(primary))}, 1));
            wearer_ = differ ? make_kernel(p, wearer, pupil_mm, pixel_rad) : *person_;
            kept_params_ = p;
            kept_pupil_mm_ = pupil_mm;
            kept_pixel_rad_ = pixel_rad;
        }
        frame.image = seen(frame.image, scatter, *person_, *wearer_, differ, frame.scene_white_cd_m2, static_cast<double>(p.rescatter), p.photographic > 0.5f,
                           primaries_);
    }

private:
    // The tables take a second; the last ones are kept.
    std::optional<Kernel> person_, wearer_;
    std::vector<Kernel> primaries_;  // with emission_spectra
    ClosedFormParams kept_params_{};
    double kept_pupil_mm_ = 0, kept_pixel_rad_ = 0;
};

}  // namespace

std::unique_ptr<ReferenceModel> make_closed_form_reference() { return std::make_unique<ClosedFormReference>(); }

}  // namespace entoptic::perception
