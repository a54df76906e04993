#include "perception/glare/fraunhofer_mask_psf.h"

#include "perception/glare/fraunhofer_mask_math.glsl"
#include "perception/glare/glare_spectrum.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

using namespace fraunhofer_mask;
using Complex = std::complex<double>;

constexpr double pi = 3.14159265358979323846;

double sinc(double x) { return std::abs(x) < 1e-9 ? 1 : std::sin(pi * x) / (pi * x); }

// Stockham, radix 2: natural order in and out.
void transform_line(Complex* line, Complex* spare, int n, const std::vector<Complex>& turns) {
    Complex *from = line, *to = spare;
    for (int half = n / 2, stride = 1; half >= 1; half /= 2, stride *= 2) {
        for (int p = 0; p < half; ++p) {
            const Complex w = turns[static_cast<std::size_t>(p) * static_cast<std::size_t>(stride)];
            for (int q = 0; q < stride; ++q) {
                const Complex a = from[q + stride * p], b = from[q + stride * (p + half)], d = a - b;
                to[q + stride * 2 * p] = a + b;
                to[q + stride * (2 * p + 1)] = {d.real() * w.real() - d.imag() * w.imag(), d.real() * w.imag() + d.imag() * w.real()};
            }
        }
        std::swap(from, to);
    }
    if (from != line) std::copy(from, from + n, line);
}

// Density times f^3 over the logarithm of frequency and azimuth; rows as those of the table, from its first sine at the longest wavelength.
struct FrequencyTable {
    double first_per_mm = 0;
    int rows = 0;
    std::vector<double> value;
    double at(double row, std::size_t column) const {
        const double r = std::clamp(row, 0.0, rows - 1.0);
        const auto low = static_cast<std::size_t>(std::min(r, rows - 2.0));
        const double part = r - static_cast<double>(low);
        return (1 - part) * value[low * mask_columns + column] + part * value[(low + 1) * mask_columns + column];
    }
};

// Between samples of the density, bins from the middle.
double density_at(const Psf& psf, double x, double y) {
    const double u = x + psf.most, v = y + psf.most;
    const int i = std::clamp(static_cast<int>(u), 0, 2 * psf.most - 1), j = std::clamp(static_cast<int>(v), 0, 2 * psf.most - 1);
    const double a = u - i, b = v - j;
    return (1 - b) * ((1 - a) * psf.density.at(i, j, 0) + a * psf.density.at(i + 1, j, 0)) +
           b * ((1 - a) * psf.density.at(i, j + 1, 0) + a * psf.density.at(i + 1, j + 1, 0));
}

FrequencyTable make_frequency_table(const Psf& psf, double longest_um) {
    FrequencyTable t;
    t.first_per_mm = mask_first_sine() / (longest_um * 1e-3);
    const double end = psf.used_per_mm();
    // The last row stands for all beyond: the mean of the outermost part, since a single row shows one phase of the fringes only.
    const int inner = std::max(static_cast<int>(std::log(end / t.first_per_mm) / mask_step()), 2),
              averaged = std::min(inner, 77);  // a factor of 1.6
    t.rows = inner + 1;
    t.value.assign(static_cast<std::size_t>(t.rows) * mask_columns, 0.0);
    for (int row = 0; row < inner; ++row) {
        const double f = t.first_per_mm * std::exp(row * mask_step()), bins = f / psf.bin_per_mm;
        const int n = std::max(1, static_cast<int>(std::ceil(bins * mask_step())));
        for (uint column = 0; column < mask_columns; ++column) {
            double sum = 0;
            for (int j = 0; j < n; ++j)
                for (int i = 0; i < n; ++i) {
                    const double r = bins * std::exp(((j + 0.5) / n - 0.5) * mask_step()), azimuth = (column + (i + 0.5) / n) * mask_step();
                    sum += density_at(psf, r * std::cos(azimuth), r * std::sin(azimuth));
                }
            t.value[static_cast<std::size_t>(row) * mask_columns + column] = sum / (n * n) * f * f * f;
        }
    }
    for (uint column = 0; column < mask_columns; ++column) {
        double sum = 0;
        for (int row = inner - averaged; row < inner; ++row) sum += t.value[static_cast<std::size_t>(row) * mask_columns + column];
        t.value[static_cast<std::size_t>(inner) * mask_columns + column] = sum / averaged;
    }
    return t;
}

void add_levels(std::vector<vec3>& table) {
    for (uint level = 1; level < mask_levels; ++level) {
        const uint columns = mask_columns >> level, rows = mask_rows >> level, from = mask_level_start(level - 1),
                   to = mask_level_start(level);
        for (uint row = 0; row < rows; ++row)
            for (uint column = 0; column < columns; ++column) {
                const uint at = from + 2 * row * 2 * columns + 2 * column;
                table[to + row * columns + column] =
                    0.25f * (table[at] + table[at + 1] + table[at + 2 * columns] + table[at + 2 * columns + 1]);
            }
    }
}

}  // namespace

std::vector<Complex> inner_transform(const ImageD& plane, int most) {
    const int n = plane.width, columns = most + 1;
    std::vector<Complex> turns(static_cast<std::size_t>(n) / 2), spare(static_cast<std::size_t>(n)), line(static_cast<std::size_t>(n));
    for (int k = 0; k < n / 2; ++k) turns[static_cast<std::size_t>(k)] = std::polar(1.0, -2 * pi * k / n);
    std::vector<Complex> rows(static_cast<std::size_t>(n) * static_cast<std::size_t>(columns));
    const auto row = [&](int y, int u) -> Complex& {
        return rows[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(u)];
    };
    // Two rows as real and imaginary part of one.
    for (int y = 0; y < n; y += 2) {
        const auto from = plane.data.begin() + static_cast<std::ptrdiff_t>(y) * n;
        if (std::all_of(from, from + 2 * n, [](double t) { return t == 0; })) continue;
        for (int x = 0; x < n; ++x) line[static_cast<std::size_t>(x)] = {from[x], from[n + x]};
        transform_line(line.data(), spare.data(), n, turns);
        for (int u = 0; u < columns; ++u) {
            const Complex plus = line[static_cast<std::size_t>(u)], minus = std::conj(line[static_cast<std::size_t>((n - u) % n)]);
            row(y, u) = 0.5 * (plus + minus);
            row(y + 1, u) = Complex(0, -0.5) * (plus - minus);
        }
    }
    const int side = 2 * most + 1;
    std::vector<Complex> out(static_cast<std::size_t>(columns) * static_cast<std::size_t>(side));
    for (int u = 0; u < columns; ++u) {
        for (int y = 0; y < n; ++y) line[static_cast<std::size_t>(y)] = row(y, u);
        transform_line(line.data(), spare.data(), n, turns);
        for (int v = -most; v <= most; ++v)
            out[static_cast<std::size_t>(u) * static_cast<std::size_t>(side) + static_cast<std::size_t>(v + most)] =
                line[static_cast<std::size_t>((v + n) % n)];
    }
    return out;
}

PsfSampling psf_sampling(int n, double plane_mm, double wavelength_nm) {
    const double lambda_mm = wavelength_nm * 1e-6, pitch_mm = plane_mm / n;
    return {pitch_mm * 1000, lambda_mm / plane_mm * 180 / pi, std::asin(std::min(lambda_mm / (2 * pitch_mm), 1.0)) * 180 / pi};
}

Psf make_psf(const ApertureRaster& aperture) {
    const int n = aperture.n, most = n / 4, side = 2 * most + 1;
    Psf psf{most, 1 / aperture.plane_mm, ImageD(side, side, 1)};
    if (aperture.passed <= 0) return psf;
    const std::vector<Complex> transformed = inner_transform(aperture.amplitude, most);
    // Parseval: |F|^2 over all frequencies sums to n^2 times what passes. A sample is the mean over its square, which damps |F|^2 by sinc^2 of
    // each frequency (trap L12).
    std::vector<double> undamped(static_cast<std::size_t>(most) + 1);
    for (int k = 0; k <= most; ++k) undamped[static_cast<std::size_t>(k)] = std::pow(sinc(static_cast<double>(k) / n), -2);
    const double scale = 1 / (static_cast<double>(n) * n * aperture.passed * psf.bin_per_mm * psf.bin_per_mm);
    for (int u = 0; u <= most; ++u)
        for (int v = -most; v <= most; ++v) {
            const Complex f =
                transformed[static_cast<std::size_t>(u) * static_cast<std::size_t>(side) + static_cast<std::size_t>(v + most)];
            const double energy =
                std::norm(f) * undamped[static_cast<std::size_t>(u)] * undamped[static_cast<std::size_t>(std::abs(v))] * scale;
            psf.density.at(most + u, most + v, 0) = psf.density.at(most - u, most - v, 0) = energy;
        }
    return psf;
}

DiffractedSpectrum diffracted_spectrum(const FraunhoferMaskParams& p) {
    if (p.three_lines > 0.5f) return {{0.680, 0.530, 0.460}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const GlareSpectrum midpoints = midpoint_spectrum(std::clamp(static_cast<int>(std::lround(p.wavelengths)), 3, 64));
    DiffractedSpectrum s;
    for (const double nm : midpoints.nm) s.lambda_um.push_back(nm / 1000);
    s.weight = midpoints.weight;
    return s;
}

std::vector<vec3> make_mask_table(const Psf& psf, const DiffractedSpectrum& spectrum) {
    std::vector<vec3> table(mask_level_start(mask_levels), vec3(0));
    const double longest = *std::max_element(spectrum.lambda_um.begin(), spectrum.lambda_um.end());
    const FrequencyTable frequencies = make_frequency_table(psf, longest);
    std::vector<glm::dvec3> line(mask_columns);
    for (uint row = 0; row < mask_rows; ++row) {
        std::fill(line.begin(), line.end(), glm::dvec3(0));
        for (std::size_t i = 0; i < spectrum.lambda_um.size(); ++i) {
            // f = sine / lambda: another wavelength is a shift of rows. K theta^3 = sum of weight lambda^-2 S(f) (f lambda)^3.
            const double at = row + std::log(longest / spectrum.lambda_um[i]) / mask_step();
            const glm::dvec3 share = spectrum.weight[i] * (spectrum.lambda_um[i] * 1e-3);
            for (uint column = 0; column < mask_columns; ++column) line[column] += share * frequencies.at(at, column);
        }
        for (uint column = 0; column < mask_columns; ++column) table[row * mask_columns + column] = glm::max(line[column], glm::dvec3(0));
    }
    add_levels(table);
    return table;
}

double diffracted_beyond(const std::vector<vec3>& table, double sine) {
    glm::dvec3 sum{0};
    const auto ring = [&](uint row) {
        glm::dvec3 total{0};
        for (uint column = 0; column < mask_columns; ++column) total += glm::dvec3(table[row * mask_columns + column]);
        return 2 * mask_step() * total;  // both halves of the turn
    };
    // K theta dtheta = T theta^-2 dtheta = T / theta dlog(theta).
    for (uint row = static_cast<uint>(std::clamp(std::floor(mask_row(sine)), 0.0, mask_rows - 1.0)); row < mask_rows; ++row)
        sum += ring(row) * (mask_step() / mask_sine(row));
    sum += ring(mask_rows - 1) / std::max(mask_sine(mask_rows - 0.5), sine);
    return std::max({sum.x, sum.y, sum.z});
}

}  // namespace entoptic::perception
