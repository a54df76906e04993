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
constexpr int azimuths = 240;

double sinc(double x) { return std::abs(x) < 1e-9 ? 1 : std::sin(pi * x) / (pi * x); }

// Light per (1/mm)² of frequency, its mean over the azimuth; energy of all 1.
class RingMean {
public:
    explicit RingMean(const ApertureRaster& a) : aperture_(a), pitch_(a.plane_mm / a.n), step_(pitch_ / 2), count_(3 * a.n) {
        for (int k = 0; k < azimuths; ++k) projections_.push_back(projection((k + 0.5) * pi / azimuths));
    }
    // At a frequency, 1/mm; from a quarter of the sampling frequency on by the law of f^-3 from the outermost part.
    double at(double f) const {
        const double end = 0.25 * aperture_.n / aperture_.plane_mm;
        if (f <= end) return within(f);
        double sum = 0;
        constexpr int n = 24;
        for (int i = 0; i < n; ++i) {
            const double inner = end * std::pow(1.6, -(i + 0.5) / n);
            sum += within(inner) * std::pow(inner / f, 3) / n;
        }
        return sum;
    }

private:
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
    double within(double f) const {
        double sum = 0;
        for (int k = 0; k < azimuths; ++k) {
            const double azimuth = (k + 0.5) * pi / azimuths;
            const std::complex<double> turn = std::polar(1.0, -2 * pi * f * step_);
            std::complex<double> phase = 1, total = 0;
            for (const double t : projections_[static_cast<std::size_t>(k)]) total += t * phase, phase *= turn;
            // Samples are means over their squares; the projection shares them out linearly.
            const double damped = sinc(f * std::cos(azimuth) * pitch_) * sinc(f * std::sin(azimuth) * pitch_) * std::pow(sinc(f * step_), 2);
            sum += std::norm(total) / (damped * damped);
        }
        return sum / azimuths * pitch_ * pitch_ / aperture_.passed;
    }
    const ApertureRaster& aperture_;
    double pitch_, step_;
    int count_;
    std::vector<std::vector<double>> projections_;
};

}  // namespace

std::vector<double> fraunhofer_mask_scatter(const CurveInput& in, std::span<const double> degrees) {
    const auto p = in.as<FraunhoferMaskParams>();
    const double plane = mask_plane_over_pupil * in.own[0];
    const ApertureRaster aperture = raster_aperture(p, nullptr, {in.own[0], static_cast<double>(p.lid_open), 0}, 512, plane);
    const RingMean light(aperture);
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
