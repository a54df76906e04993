// fraunhofer_mask in double from the definition, with none of the model's code: the aperture as points of light or shadow, its Fourier transform
// by Eigen's, the PSF of each wavelength integrated over each pixel, no table and no grid, and every pixel's light to every other.
#include "perception/glare/fraunhofer_mask_aperture.h"
#include "perception/glare/fraunhofer_mask_tables.h"
#include "perception/glare/glare.h"
#include "perception/glare/glare_reference.h"
#include "shaders/geometry.glsl"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstring>
#include <unsupported/Eigen/FFT>

namespace entoptic::perception {
namespace {

using Complex = std::complex<double>;

constexpr double pi = 3.14159265358979323846;
constexpr double plane_over_pupil = 1.25;
// A side of the plane. Of frequencies a quarter of the samples each way is used: farther out the aperture's edges alias.
constexpr int fewest_samples = 1024, most_samples = 4096, fewest_points = 4096;

// Which points of `n` a side lie in the shadow of a lash.
std::vector<std::uint8_t> lash_shadows(const FraunhoferMaskParams& p, double pupil_mm, double open, double shift_mm, int n) {
    std::vector<std::uint8_t> dark(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), 0);
    if (p.lashes < 0.5f) return dark;
    const double half = 0.5 * static_cast<double>(p.lash_width_mm), step = plane_over_pupil * pupil_mm / n;
    for (const Lash& lash : grow_lashes(p, open, shift_mm))
        for (double s = 0; s <= 1; s += step / lash.length) {
            const glm::dvec2 at = lash.at(s);
            if (glm::length(at) > pupil_mm / 2 + half) continue;
            const glm::dvec2 ahead = lash.at(s + 1e-4) - at, across = glm::normalize(glm::dvec2(-ahead.y, ahead.x));
            // A line across the lash: the points whose middles lie within its width, seen along that line.
            for (double d = -half - step; d <= half + step; d += 0.4 * step) {
                const glm::dvec2 q = at + d * across;
                const int i = static_cast<int>(std::floor(q.x / step + n / 2.0)), j = static_cast<int>(std::floor(-q.y / step + n / 2.0));
                if (i < 0 || j < 0 || i >= n || j >= n) continue;
                const glm::dvec2 middle{(i + 0.5 - n / 2.0) * step, -(j + 0.5 - n / 2.0) * step};
                if (std::abs(glm::dot(middle - at, across)) <= half)
                    dark[static_cast<std::size_t>(j) * static_cast<std::size_t>(n) + static_cast<std::size_t>(i)] = 1;
            }
        }
    return dark;
}

// Where light passes, point by point: of each of `samples` x `samples` the mean of amplitude and that of its square.
ImageD point_aperture(const FraunhoferMaskParams& p, const MaskPicture* picture, double pupil_mm, double open, double shift_mm,
                      int samples) {
    const int n = std::max(2 * samples, fewest_points), points = n / samples;
    const double plane = plane_over_pupil * pupil_mm, step = plane / n;
    const auto mm = [&](int i) { return (i + 0.5 - n / 2.0) * step; };
    const auto blades = static_cast<int>(std::lround(p.blades)), directions = static_cast<int>(std::lround(p.filter_directions));
    const LidEdges lids = lid_edges(open);
    const auto passes = [&](double x, double y) -> double {
        const double radius = pupil_mm / 2, r = std::sqrt(x * x + y * y);
        if (r > radius) return 0;
        if (blades >= 3 && r > radius * std::cos(pi / blades)) {
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
        const int i = static_cast<int>(std::floor(u * cells_a_mm + t.width / 2.0)),
                  j = static_cast<int>(std::floor(-y * cells_a_mm + t.height / 2.0));
        return t.at(std::clamp(i, 0, t.width - 1), std::clamp(j, 0, t.height - 1), 0);
    };
    const std::vector<std::uint8_t> dark = lash_shadows(p, pupil_mm, open, shift_mm, n);
    ImageD mean(samples, samples, 2);
    const double part = 1.0 / (points * points);
    for (int j = 0; j < n; ++j)
        for (int sample = 0, first = 0; sample < samples; ++sample, first += points) {
            double sum = 0, squares = 0;
            for (int i = first; i < first + points; ++i)
                if (dark[static_cast<std::size_t>(j) * static_cast<std::size_t>(n) + static_cast<std::size_t>(i)] == 0) {
                    const double t = passes(mm(i), -mm(j));
                    sum += t;
                    squares += t * t;
                }
            mean.at(sample, j / points, 0) += sum * part;
            mean.at(sample, j / points, 1) += squares * part;
        }
    return mean;
}

// A rectangle of frequencies: its middle, and half of its width and height.
struct Cell {
    glm::dvec2 middle, half;
};

// Energy per (1/mm)^2 of frequency, between the transform's samples linearly, on a square of frequencies up to a quarter of the sampling frequency.
class Spectrum {
public:
    Spectrum(const ImageD& aperture, double pupil_mm)
        : samples_(aperture.width), most_(samples_ / 4), bin_(1 / (plane_over_pupil * pupil_mm)), energy_(2 * most_ + 1, 2 * most_ + 1, 1) {
        double passed = 0;
        for (std::size_t i = 1; i < aperture.data.size(); i += 2) passed += aperture.data[i];
        if (passed <= 0) return;
        // F(-u, -v) is the conjugate of F(u, v): columns from 0 on are enough.
        const auto n = static_cast<std::size_t>(samples_), columns = static_cast<std::size_t>(most_) + 1;
        Eigen::FFT<double> transform;
        std::vector<Complex> rows(n * columns), line(n), transformed(n);
        for (std::size_t y = 0; y < n; ++y) {
            for (std::size_t x = 0; x < n; ++x) line[x] = aperture.data[2 * (y * n + x)];
            if (std::all_of(line.begin(), line.end(), [](Complex c) { return c == Complex(0); })) continue;
            transform.fwd(transformed, line);
            std::copy_n(transformed.begin(), columns, rows.begin() + static_cast<std::ptrdiff_t>(y * columns));
        }
        const auto sinc = [](double x) { return x == 0 ? 1 : std::sin(pi * x) / (pi * x); };
        for (int u = 0; u <= most_; ++u) {
            for (std::size_t y = 0; y < n; ++y) line[y] = rows[y * columns + static_cast<std::size_t>(u)];
            transform.fwd(transformed, line);
            for (int v = -most_; v <= most_; ++v) {
                const double damped = sinc(static_cast<double>(u) / samples_) * sinc(static_cast<double>(v) / samples_);
                const double e = std::norm(transformed[static_cast<std::size_t>((v + samples_) % samples_)]) /
                                 (damped * damped * samples_ * samples_ * passed * bin_ * bin_);
                energy_.at(most_ + u, most_ + v, 0) = energy_.at(most_ - u, most_ - v, 0) = e;
            }
        }
    }
    // Mean over a cell, 1/mm; beyond the square by the law of f^-3 along the azimuth, from the outermost part.
    double mean(const Cell& cell) const {
        const double f = glm::length(cell.middle), end = (most_ - 1) * bin_ - glm::length(cell.half);
        if (f <= end) return within(cell);
        double sum = 0;
        constexpr int n = 32;
        for (int i = 0; i < n; ++i) {
            const double nearer = std::min(1.0, end / f) * std::pow(1.6, -(i + 0.5) / n);
            sum += within({nearer * cell.middle, nearer * cell.half}) * std::pow(nearer, 3) / n;
        }
        return sum;
    }

private:
    // Of the tents between samples, what each has inside: exact.
    double within(const Cell& cell) const {
        double sum = 0;
        const glm::dvec2 middle = cell.middle / bin_ + static_cast<double>(most_), half = glm::max(cell.half / bin_, glm::dvec2(1e-6));
        const int left = std::max(static_cast<int>(std::floor(middle.x - half.x)), 0),
                  right = std::min(static_cast<int>(std::ceil(middle.x + half.x)), 2 * most_);
        const int top = std::max(static_cast<int>(std::floor(middle.y - half.y)), 0),
                  bottom = std::min(static_cast<int>(std::ceil(middle.y + half.y)), 2 * most_);
        double across[most_samples / 2 + 1];
        for (int x = left; x <= right; ++x) across[x - left] = share(x, middle.x, half.x);
        for (int y = top; y <= bottom; ++y) {
            double row = 0;
            for (int x = left; x <= right; ++x) row += across[x - left] * energy_.at(x, y, 0);
            sum += row * share(y, middle.y, half.y);
        }
        return sum;
    }
    // Mean over [middle - half, middle + half] of the tent about a sample.
    static double share(int sample, double middle, double half) {
        const auto area_until = [](double t) {
            return t < -1 ? 0 : t > 1 ? 1 : t < 0 ? 0.5 * (1 + t) * (1 + t) : 1 - 0.5 * (1 - t) * (1 - t);
        };
        return (area_until(middle + half - sample) - area_until(middle - half - sample)) / (2 * half);
    }
    int samples_, most_;
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
        const int samples = samples_for(frame.geometry, p, pupil_mm);
        std::vector<Spectrum> spectra;
        for (int z = 0; z < zones; ++z) {
            const double shift_mm = -static_cast<double>(p.obstacle_mm) * std::tan(zone_angle_rad(z, zones));
            spectra.emplace_back(point_aperture(p, picture_.get(), pupil_mm, open, shift_mm, samples), pupil_mm);
        }
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

    // Right and down on the azimuthal equidistant plane, rad.
    static glm::dvec2 on_plane(const EyeGeometry& g, glm::dvec2 px) {
        const glm::dvec3 d = geometry::geometry_direction(g, px);
        const double side = std::hypot(d.x, d.y);
        return glm::dvec2(d.x, -d.y) * (side > 1e-12 ? std::atan2(side, -d.z) / side : 1.0);
    }

    // So many that light from corner to corner of the picture is inside the square of frequencies, if it can be.
    static int samples_for(const EyeGeometry& g, const FraunhoferMaskParams& p, double pupil_mm) {
        const double across = std::min(glm::length(on_plane(g, {g.width, g.height}) - on_plane(g, {0, 0})), pi / 2);
        double shortest_nm = 1e9;
        for (const auto& wave : waves(p)) shortest_nm = std::min(shortest_nm, wave.nm);
        const double bins = std::sin(across) / (shortest_nm * 1e-6) * plane_over_pupil * pupil_mm;
        int samples = fewest_samples;
        while (samples < most_samples && samples / 4 < bins) samples *= 2;
        return samples;
    }

    // Light from the pixel at `source` per unit of luminance to the pixel at `to`, through its zone's aperture.
    static glm::dvec3 arriving(const EyeGeometry& g, const std::vector<glare_reference::Wave>& waves, const std::vector<Spectrum>& spectra,
                               glm::dvec2 source, glm::dvec2 to) {
        const glm::dvec3 towards = geometry::geometry_direction(g, source);
        const int zones = static_cast<int>(spectra.size());
        const double place = zones > 1 ? std::clamp(std::atan2(towards.x, -towards.z) / (pi / 2) + 0.5, 0.0, 1.0) * (zones - 1) : 0;
        const glm::dvec2 from = on_plane(g, source);
        const glm::dvec2 right = on_plane(g, to + glm::dvec2(0.5, 0)) - on_plane(g, to - glm::dvec2(0.5, 0)),
                         down = on_plane(g, to + glm::dvec2(0, 0.5)) - on_plane(g, to - glm::dvec2(0, 0.5));
        // Cells a side of the pixel: each a rectangle, though the pixel may be a little turned or sheared.
        constexpr int n = 2;
        const glm::dvec2 half = (glm::abs(right) + glm::abs(down)) / (2.0 * n);
        glm::dvec3 sum{0};
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const glm::dvec2 offset = on_plane(g, to + (glm::dvec2(i, j) + 0.5) / static_cast<double>(n) - 0.5) - from;
                const double theta = glm::length(offset), sine = std::sin(theta) / theta;
                for (const auto& wave : waves) {
                    const double lambda_mm = wave.nm * 1e-6;
                    double energy = 0;
                    for (int z = 0; z < zones; ++z)
                        if (const double share = std::max(1 - std::abs(place - z), 0.0); share > 0)
                            energy +=
                                share * spectra[static_cast<std::size_t>(z)].mean({offset * (sine / lambda_mm), half * (sine / lambda_mm)});
                    for (int c = 0; c < 3; ++c) sum[c] += wave.weight[static_cast<std::size_t>(c)] * energy / (lambda_mm * lambda_mm);
                }
            }
        return sum / static_cast<double>(n * n);
    }

    static void scatter(ReferenceFrame& frame, const FraunhoferMaskParams& p, const std::vector<Spectrum>& spectra) {
        const ImageD in = frame.image;
        const bool whole = p.photographic > 0.5f;
        const double white = frame.scene_white_cd_m2;
        const auto spectrum = waves(p);
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
                        const glm::dvec3 share = static_cast<double>(p.strength) * arriving(frame.geometry, spectrum, spectra, source, to);
                        const double of_here = geometry::geometry_solid_angle(frame.geometry, to);
                        for (int c = 0; c < 3; ++c) {
                            veil.at(x, y, c) += share[c] * of_source * light[c];
                            if (whole) veil.at(sx, sy, c) -= share[c] * of_here * light[c];
                        }
                    }
            }
        const auto curve = [](double v) {
            return 640 * (std::pow(std::max(v, 0.0), 0.465) + 1 / 20.0) / (std::pow(std::max(v, 0.0), 0.465) + 20);
        };
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
