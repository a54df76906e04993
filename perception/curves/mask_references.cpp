// Reference of the curve glare.psf by fraunhofer_mask: along an azimuth the two-dimensional transform of an aperture is the one-dimensional
// transform of its projection (Bracewell 1956), so no plane is transformed, and no fast transform is used.
#include "perception/curves/curve_references.h"
#include "perception/glare/fraunhofer_mask_tables.h"
#include "perception/glare/glare_reference.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace entoptic::perception::curve_reference {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int azimuths = 360;
constexpr int per_fringe = 4;       // samples of frequency: the pattern of a pupil D wide has fringes 1/D apart

double sinc(double x) { return std::abs(x) < 1e-9 ? 1 : std::sin(pi * x) / (pi * x); }

// Light per (1/mm)² of frequency, its mean over the azimuth and over one fringe; energy of all 1.
class RingMean {
public:
    RingMean(const ApertureRaster& a, double pupil_mm)
        : aperture_(a), pitch_(a.plane_mm / a.n), step_(pitch_ / 8), count_(8 * a.n),
          first_(static_cast<int>(0.5 * (count_ - pupil_mm / step_)) - 8), bin_(1 / (per_fringe * pupil_mm)) {
        for (int k = 0; k < azimuths; ++k) projections_.push_back(projection((k + 0.5) * pi / azimuths));
        // Times the frequency cubed, which makes it level. Up to a quarter of the sampling frequency; from there on it stays what its outermost
        // part, a factor of 1.6 wide, is in the mean.
        const int last = static_cast<int>(0.25 * a.n / a.plane_mm / bin_), outermost = static_cast<int>(last / 1.6);
        for (int i = 0; i <= last; ++i) level_.push_back(within(i * bin_) * std::pow(i * bin_, 3));
        for (int i = outermost; i < last; ++i) tail_ += level_[static_cast<std::size_t>(i)] / (last - outermost);
    }
    // At a frequency, 1/mm. Within the first two fringes, where the pattern is not level, the pattern itself.
    double at(double f) const {
        if (f < 2 * per_fringe * bin_) return within(f);
        return fringe_mean(f / bin_) / (f * f * f);
    }

private:
    double level(double place) const {
        const auto i = static_cast<std::size_t>(place);
        const double part = place - std::floor(place);
        return i + 1 < level_.size() ? (1 - part) * level_[i] + part * level_[i + 1] : tail_;
    }
    double fringe_mean(double place) const {
        double sum = 0;
        for (int i = 0; i < per_fringe; ++i) sum += level(place + i + 0.5 - 0.5 * per_fringe) / per_fringe;
        return sum;
    }
    std::vector<double> projection(double azimuth) const {
        std::vector<double> line(static_cast<std::size_t>(count_));
        const double c = std::cos(azimuth), s = std::sin(azimuth);
        for (int y = 0; y < aperture_.n; ++y)
            for (int x = 0; x < aperture_.n; ++x) {
                const double t = aperture_.amplitude.at(x, y, 0);
                if (t == 0) continue;
                const double u = ((x + 0.5 - aperture_.n / 2.0) * c + (y + 0.5 - aperture_.n / 2.0) * s) * pitch_ / step_ + count_ / 2.0;
                const auto i = static_cast<std::size_t>(u);
                const double part = u - std::floor(u);
                line[i] += (1 - part) * t;
                line[i + 1] += part * t;
            }
        return line;
    }
    // Energy per (1/mm)² at a frequency, mean over the azimuth.
    double within(double f) const {
        double sum = 0;
        for (int k = 0; k < azimuths; ++k) {
            const double azimuth = (k + 0.5) * pi / azimuths;
            const std::complex<double> turn = std::polar(1.0, -2 * pi * f * step_);
            std::complex<double> phase = 1, total = 0;
            for (int i = first_; i < count_ - first_; ++i) {
                total += projections_[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)] * phase;
                // Written out: the operator minds infinities, which costs three times as much.
                phase = {phase.real() * turn.real() - phase.imag() * turn.imag(), phase.real() * turn.imag() + phase.imag() * turn.real()};
            }
            // Samples are means over their squares; the projection shares them out linearly.
            const double damped = sinc(f * std::cos(azimuth) * pitch_) * sinc(f * std::sin(azimuth) * pitch_) * std::pow(sinc(f * step_), 2);
            sum += std::norm(total) / (damped * damped);
        }
        return sum / azimuths * pitch_ * pitch_ / aperture_.passed;
    }
    const ApertureRaster& aperture_;
    double pitch_, step_;
    int count_, first_;      // of a projection; before first_ it is dark
    double bin_, tail_ = 0;
    std::vector<double> level_;
    std::vector<std::vector<double>> projections_;
};

}  // namespace

std::vector<double> fraunhofer_mask_scatter(const CurveInput& in, std::span<const double> degrees) {
    const auto p = in.as<FraunhoferMaskParams>();
    const double plane = mask_plane_over_pupil * in.own[0];
    const ApertureRaster aperture = raster_aperture(p, nullptr, {in.own[0], static_cast<double>(p.lid_open), 0}, mask_samples / 4, plane);
    const RingMean light(aperture, in.own[0]);
    const DiffractedSpectrum spectrum = in.own[1] > 0 ? DiffractedSpectrum{{in.own[1] / 1000}, {glm::dvec3(1)}} : diffracted_spectrum(p);
    std::vector<double> values;
    for (const double deg : degrees) {
        // The model spreads what is nearer than its first sine evenly; here it is the pattern itself.
        const double sine = std::sin(deg * pi / 180);
        double sum = 0;
        for (std::size_t i = 0; i < spectrum.lambda_um.size(); ++i) {
            const double lambda_mm = spectrum.lambda_um[i] * 1e-3;
            sum += glm::dot(glm::dvec3(0.2126, 0.7152, 0.0722), spectrum.weight[i]) * light.at(sine / lambda_mm) / (lambda_mm * lambda_mm);
        }
        values.push_back(sum);
    }
    return values;
}

}  // namespace entoptic::perception::curve_reference
