// fraunhofer_mask in double from the definition: the aperture as points of light or shadow, its Fourier transform summed by the definition
// at each frequency (no fast transform), the PSF of each wavelength averaged over each pixel, and every pixel's light to every other.
#include "perception/glare/fraunhofer_mask_aperture.h"
#include "perception/glare/fraunhofer_mask_tables.h"
#include "perception/glare/glare.h"
#include "perception/glare/glare_reference.h"
#include "shaders/geometry.glsl"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>

namespace entoptic::perception {
namespace {

using Complex = std::complex<double>;

constexpr double pi = 3.14159265358979323846;
constexpr int samples = 768, points = 4;      // a side of the plane; points a side of a sample
constexpr double plane_over_pupil = 1.25;

// Where light passes, point by point.
ImageD point_aperture(const FraunhoferMaskParams& p, const MaskPicture* picture, double pupil_mm, double open, double shift_mm) {
    constexpr int n = samples * points;
    const double plane = plane_over_pupil * pupil_mm, step = plane / n;
    const auto mm = [&](int i) { return (i + 0.5 - n / 2.0) * step; };
    std::vector<float> light(static_cast<std::size_t>(n) * n, 0.0f);
    const auto blades = static_cast<int>(std::lround(p.blades)), directions = static_cast<int>(std::lround(p.filter_directions));
    const LidEdges lids = lid_edges(open);
    const auto passes = [&](double x, double y) -> double {
        const double r = std::hypot(x, y), radius = pupil_mm / 2;
        if (r > radius) return 0;
        if (blades >= 3) {
            const double sector = 2 * pi / blades, turned = std::atan2(y, x) - static_cast<double>(p.blade_rotation_deg) * pi / 180;
            const double within = turned - sector * std::floor(turned / sector) - sector / 2;
            if (r * std::cos(within) > radius * std::cos(sector / 2)) return 0;
        }
        const double u = x - shift_mm, from_lid = x - lid_shift_mm(p, shift_mm), bend = from_lid * from_lid / (2 * lid_radius_mm);
        if (p.lids > 0.5f && (y > lids.upper - bend || y < lids.lower + bend)) return 0;
        for (int k = 0; k < directions; ++k) {
            const double angle = static_cast<double>(p.filter_rotation_deg) * pi / 180 + k * pi / directions;
            const double d = y * std::cos(angle) - u * std::sin(angle), spacing = static_cast<double>(p.filter_spacing_mm);
            if (std::abs(std::remainder(d, spacing)) < 0.5 * static_cast<double>(p.filter_width_mm)) return 0;
        }
        if (!picture) return 1;
        const ImageD& t = picture->transmission;
        const double cells_a_mm = t.width / static_cast<double>(p.mask_width_mm);
        const int i = static_cast<int>(std::floor(u * cells_a_mm + t.width / 2.0)), j = static_cast<int>(std::floor(-y * cells_a_mm + t.height / 2.0));
        return t.at(std::clamp(i, 0, t.width - 1), std::clamp(j, 0, t.height - 1), 0);
    };
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) light[static_cast<std::size_t>(j) * n + static_cast<std::size_t>(i)] = static_cast<float>(passes(mm(i), -mm(j)));
    if (p.lashes >= 0.5f) {
        const double half = 0.5 * static_cast<double>(p.lash_width_mm);
        for (const Lash& lash : grow_lashes(p, open, shift_mm))
            for (double s = 0; s <= 1; s += 0.25 * step / lash.length * 4) {
                const glm::dvec2 at = lash.at(s);
                if (glm::length(at) > pupil_mm / 2 + half) continue;
                const glm::dvec2 ahead = lash.at(s + 1e-4) - at, across = glm::normalize(glm::dvec2(-ahead.y, ahead.x));
                // One line across the lash.
                for (double d = -half; d <= half; d += 0.4 * step) {
                    const glm::dvec2 q = at + d * across;
                    const int i = static_cast<int>(std::floor(q.x / step + n / 2.0)), j = static_cast<int>(std::floor(-q.y / step + n / 2.0));
                    if (i >= 0 && j >= 0 && i < n && j < n) light[static_cast<std::size_t>(j) * n + static_cast<std::size_t>(i)] = 0;
                }
            }
    }
    ImageD mean(samples, samples, 2);      // of amplitude, and of its square
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const auto t = static_cast<double>(light[static_cast<std::size_t>(j) * n + static_cast<std::size_t>(i)]);
            mean.at(i / points, j / points, 0) += t / (points * points);
            mean.at(i / points, j / points, 1) += t * t / (points * points);
        }
    return mean;
}

// Energy per (1/mm)^2 of frequency, on a square of frequencies up to a quarter of the sampling frequency.
class Spectrum {
public:
    Spectrum(const ImageD& aperture, double pupil_mm) : bin_(1 / (plane_over_pupil * pupil_mm)) {
        // F(u, v) = sum over rows of exp(-2 pi i v y) sum over the row of t exp(-2 pi i u x). F(-u, -v) is its conjugate.
        std::vector<Complex> turn(samples);
        for (int k = 0; k < samples; ++k) turn[static_cast<std::size_t>(k)] = std::polar(1.0, -2 * pi * k / samples);
        const auto by = [&](int a, int b) { return turn[static_cast<std::size_t>(((a * b) % samples + samples) % samples)]; };
        double passed = 0;
        for (std::size_t i = 1; i < aperture.data.size(); i += 2) passed += aperture.data[i];
        energy_ = ImageD(2 * most + 1, 2 * most + 1, 1);
        if (passed <= 0) return;
        std::vector<Complex> rows(static_cast<std::size_t>(samples) * (most + 1));
        for (int y = 0; y < samples; ++y)
            for (int x = 0; x < samples; ++x) {
                const double t = aperture.at(x, y, 0);
                if (t == 0) continue;
                for (int u = 0; u <= most; ++u) rows[static_cast<std::size_t>(y) * (most + 1) + static_cast<std::size_t>(u)] += t * by(u, x);
            }
        const auto sinc = [](double x) { return x == 0 ? 1 : std::sin(pi * x) / (pi * x); };
        std::vector<Complex> sum(most + 1);
        for (int v = -most; v <= most; ++v) {
            std::fill(sum.begin(), sum.end(), Complex(0));
            for (int y = 0; y < samples; ++y)
                for (int u = 0; u <= most; ++u) sum[static_cast<std::size_t>(u)] += rows[static_cast<std::size_t>(y) * (most + 1) + static_cast<std::size_t>(u)] * by(v, y);
            for (int u = 0; u <= most; ++u) {
                const double damped = sinc(static_cast<double>(u) / samples) * sinc(static_cast<double>(v) / samples);
                const double e = std::norm(sum[static_cast<std::size_t>(u)]) / (damped * damped * samples * samples * passed * bin_ * bin_);
                energy_.at(most + u, most + v, 0) = energy_.at(most - u, most - v, 0) = e;
            }
        }
    }
    // At a frequency, 1/mm: between the sums, and beyond them by the law of f^-3 along the azimuth, from the outermost part.
    double at(double fx, double fy) const {
        const double f = std::hypot(fx, fy), end = (most - 1) * bin_;
        if (f <= end) return between(fx / bin_, fy / bin_);
        double sum = 0;
        constexpr int n = 32;
        for (int i = 0; i < n; ++i) {
            const double inner = end * std::pow(1.6, -(i + 0.5) / n);
            sum += between(fx / f * inner / bin_, fy / f * inner / bin_) * std::pow(inner / f, 3) / n;
        }
        return sum;
    }

private:
    double between(double x, double y) const {
        const double u = x + most, v = y + most;
        const int i = std::min(static_cast<int>(u), 2 * most - 1), j = std::min(static_cast<int>(v), 2 * most - 1);
        const double a = u - i, b = v - j;
        return (1 - b) * ((1 - a) * energy_.at(i, j, 0) + a * energy_.at(i + 1, j, 0)) +
               b * ((1 - a) * energy_.at(i, j + 1, 0) + a * energy_.at(i + 1, j + 1, 0));
    }
    static constexpr int most = samples / 4;
    double bin_;
    ImageD energy_;
};

class FraunhoferMaskReference final : public ReferenceModel {
public:
    Result<void> set_files(const FilePaths& files) override {
        const auto mask = files.find("mask");
        picture_ = nullptr;
        if (mask == files.end()) return {};
        ENTOPTIC_TRY(read, read_mask_picture(mask->second));
        picture_ = std::move(read);
        return {};
    }
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        FraunhoferMaskParams p{};
        std::memcpy(&p, values.data(), sizeof p);
        if (p.strength <= 0) return;
        // The eye in steps, as the model takes it.
        const MaskKey key = mask_key(p, static_cast<double>(frame.eye.pupil_diameter_mm), static_cast<double>(frame.eye.eyelid_open));
        const double pupil_mm = static_cast<double>(key.pupil) * static_cast<double>(p.pupil_step_mm);
        const bool lids = p.lids > 0.5f || p.lashes >= 0.5f;
        const double open = lids ? static_cast<double>(key.lid) / static_cast<double>(p.lid_steps) : 1;
        const int zones = static_cast<int>(std::lround(p.zones));
        std::vector<Spectrum> spectra;
        for (int z = 0; z < zones; ++z)
            spectra.emplace_back(point_aperture(p, picture_.get(), pupil_mm, open, -static_cast<double>(p.obstacle_mm) * std::tan(zone_angle_rad(z, zones))), pupil_mm);
        scatter(frame, p, spectra);
    }

private:
    static std::vector<glare_reference::Wave> waves(const FraunhoferMaskParams& p) {
        if (p.three_lines > 0.5f) return {{680, {1, 0, 0}}, {530, {0, 1, 0}}, {460, {0, 0, 1}}};
        std::vector<glare_reference::Wave> list;
        glare_reference::Rgb sum{};
        const int count = static_cast<int>(std::lround(p.wavelengths));
        for (int i = 0; i < count; ++i) {
            const double nm = 400 + 300 * (i + 0.5) / count;
            list.push_back({nm, glare_reference::linear_rgb(nm)});
            for (std::size_t c = 0; c < 3; ++c) sum[c] += list.back().weight[c];
        }
        for (auto& wave : list)
            for (std::size_t c = 0; c < 3; ++c) wave.weight[c] /= sum[c];
        return list;
    }

    // Light from the pixel at `source` per unit of luminance to the pixel at `to`, through its zone's aperture.
    static glm::dvec3 arriving(const EyeGeometry& g, const FraunhoferMaskParams& p, const std::vector<Spectrum>& spectra, glm::dvec2 source, glm::dvec2 to) {
        const auto plane = [](glm::dvec3 d) {     // right and down on the azimuthal equidistant plane
            const double side = std::hypot(d.x, d.y);
            return glm::dvec2(d.x, -d.y) * (side > 1e-12 ? std::atan2(side, -d.z) / side : 1.0);
        };
        const glm::dvec3 towards = geometry::geometry_direction(g, source);
        const int zones = static_cast<int>(spectra.size());
        const double place = zones > 1 ? std::clamp(std::atan2(towards.x, -towards.z) / (pi / 2) + 0.5, 0.0, 1.0) * (zones - 1) : 0;
        const glm::dvec2 from = plane(towards);
        constexpr int n = 12;        // points a side of the pixel: 0.07 degrees in steps of one lambda / D
        glm::dvec3 sum{0};
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const glm::dvec2 offset = plane(geometry::geometry_direction(g, to + (glm::dvec2(i, j) + 0.5) / static_cast<double>(n) - 0.5)) - from;
                const double theta = glm::length(offset), sine = std::sin(theta) / theta;
                for (const auto& wave : waves(p)) {
                    const double lambda_mm = wave.nm * 1e-6;
                    double energy = 0;
                    for (int z = 0; z < zones; ++z)
                        if (const double share = std::max(1 - std::abs(place - z), 0.0); share > 0)
                            energy += share * spectra[static_cast<std::size_t>(z)].at(offset.x * sine / lambda_mm, offset.y * sine / lambda_mm);
                    for (int c = 0; c < 3; ++c) sum[c] += wave.weight[static_cast<std::size_t>(c)] * energy / (lambda_mm * lambda_mm);
                }
            }
        return sum * (static_cast<double>(p.strength) / (n * n));
    }

    static void scatter(ReferenceFrame& frame, const FraunhoferMaskParams& p, const std::vector<Spectrum>& spectra) {
        const ImageD in = frame.image;
        const bool whole = p.photographic > 0.5f;
        const double white = frame.scene_white_cd_m2;
        ImageD veil(in.width, in.height, 3);
        for (int sy = 0; sy < in.height; ++sy)
            for (int sx = 0; sx < in.width; ++sx) {
                glm::dvec3 light;
                for (int c = 0; c < 3; ++c) light[c] = whole ? in.at(sx, sy, c) : std::max(in.at(sx, sy, c) - white, 0.0);
                if (light == glm::dvec3(0)) continue;
                const glm::dvec2 source(sx + 0.5, sy + 0.5);
                const double of_source = geometry::geometry_solid_angle(frame.geometry, source);
                for (int y = 0; y < in.height; ++y)
                    for (int x = 0; x < in.width; ++x) {
                        const glm::dvec2 to(x + 0.5, y + 0.5);
                        if ((x == sx && y == sy) || !geometry::geometry_visible(frame.geometry, to)) continue;
                        const glm::dvec3 share = arriving(frame.geometry, p, spectra, source, to);
                        const double of_here = geometry::geometry_solid_angle(frame.geometry, to);
                        for (int c = 0; c < 3; ++c) {
                            veil.at(x, y, c) += share[c] * of_source * light[c];
                            if (whole) veil.at(sx, sy, c) -= share[c] * of_here * light[c];
                        }
                    }
            }
        const auto curve = [](double v) { return 640 * (std::pow(std::max(v, 0.0), 0.465) + 1 / 20.0) / (std::pow(std::max(v, 0.0), 0.465) + 20); };
        for (std::size_t i = 0; i < veil.data.size(); ++i) {
            const double add = p.sigmoid > 0.5f ? (curve(veil.data[i]) - curve(0)) * white / 255 : veil.data[i];
            frame.image.data[i] = std::max(in.data[i] + add, 0.0);
        }
    }

    std::shared_ptr<const MaskPicture> picture_;
};

}  // namespace

std::unique_ptr<ReferenceModel> make_fraunhofer_mask_reference();
std::unique_ptr<ReferenceModel> make_fraunhofer_mask_reference() { return std::make_unique<FraunhoferMaskReference>(); }

}  // namespace entoptic::perception
