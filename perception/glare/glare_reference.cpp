#include "perception/glare/glare_reference.h"

#include "perception/glare/glare_emission.h"

#include "shaders/geometry.glsl"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

namespace entoptic::perception::glare_reference {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr int entries = 3072;
constexpr double first = 2e-4, last = pi;

double angle_between(glm::dvec3 a, glm::dvec3 b) { return 2 * std::asin(std::min(0.5 * glm::length(a - b), 1.0)); }

}  // namespace

Kernel::Kernel(const std::function<Rgb(double)>& per_sr) {
    for (int i = 0; i < entries; ++i) table_.push_back(per_sr(first * std::pow(last / first, static_cast<double>(i) / (entries - 1))));
}

Rgb Kernel::operator()(double theta) const {
    static const double scale = (entries - 1) / std::log(last / first);
    const double place = std::clamp(std::log(std::max(theta, 1e-12) / first) * scale, 0.0, entries - 1.001);
    const auto i = static_cast<std::size_t>(place);
    const double t = place - static_cast<double>(i);
    Rgb value;
    for (std::size_t c = 0; c < 3; ++c) value[c] = table_[i][c] * (1 - t) + table_[i + 1][c] * t;
    return value;
}

// A square of pixels: what it sends, where from, and its four quarters.
struct Scatter::Square {
    Rgb light{};                           // source times solid angle
    double solid_angle = 0;
    glm::dvec3 light_centre{0}, centre{0};   // directions, weighted by light and by solid angle
    double radius = 0;                     // rad, about `centre`
    int x = 0, y = 0, size = 1;
    int quarters[4] = {-1, -1, -1, -1};
};

class Scatter::Tree {
public:
    Tree(const Scatter& scatter, const ImageD& source) : scatter_(scatter), source_(source) {
        int size = 1;
        while (size < std::max(source.width, source.height)) size *= 2;
        root = build(0, 0, size);
    }
    std::vector<Square> squares;
    int root = -1;

private:
    int build(int x, int y, int size) {
        if (x >= source_.width || y >= source_.height) return -1;
        Square square;
        square.x = x;
        square.y = y;
        square.size = size;
        if (size == 1) {
            if (!scatter_.visible(x, y)) return -1;
            square.solid_angle = scatter_.solid_angle_[scatter_.index(x, y)];
            for (int c = 0; c < 3; ++c) square.light[static_cast<std::size_t>(c)] = source_.at(x, y, c) * square.solid_angle;
            square.centre = square.light_centre = scatter_.direction(x, y);
        } else if (!join(square)) {
            return -1;
        }
        squares.push_back(square);
        return static_cast<int>(squares.size()) - 1;
    }
    bool join(Square& square) {
        const int half = square.size / 2;
        double lights = 0;
        for (int q = 0; q < 4; ++q) {
            square.quarters[q] = build(square.x + (q & 1) * half, square.y + (q >> 1) * half, half);
            if (square.quarters[q] < 0) continue;
            const Square& part = squares[static_cast<std::size_t>(square.quarters[q])];
            const double light = std::abs(part.light[0]) + std::abs(part.light[1]) + std::abs(part.light[2]);
            for (std::size_t c = 0; c < 3; ++c) square.light[c] += part.light[c];
            square.solid_angle += part.solid_angle;
            square.centre += part.solid_angle * part.centre;
            square.light_centre += light * part.light_centre;
            lights += light;
        }
        if (square.solid_angle <= 0) return false;
        square.centre = glm::normalize(square.centre);
        square.light_centre = lights > 0 ? glm::normalize(square.light_centre) : square.centre;
        for (const int q : square.quarters)
            if (q >= 0) square.radius = std::max(square.radius, glm::length(squares[static_cast<std::size_t>(q)].centre - square.centre) + squares[static_cast<std::size_t>(q)].radius);
        if (half == 1) square.radius = std::max(square.radius, std::sqrt(square.solid_angle) / 2);
        return true;
    }
    const Scatter& scatter_;
    const ImageD& source_;
};

glm::dvec3 Scatter::towards(double x, double y) const { return geometry::geometry_direction(geometry_, {x, y}); }

// Directions, solid angles (two triangles a pixel) and the smallest step between pixels.
Scatter::Scatter(const EyeGeometry& geometry) : geometry_(geometry), exact_(std::size_t(geometry.width) * geometry.height <= exact_pixels) {
    direction_.assign(std::size_t(geometry.width) * geometry.height, glm::dvec3(0));
    solid_angle_.assign(direction_.size(), 0);
    int count = 0;
    for (int y = 0; y < static_cast<int>(geometry.height); ++y)
        for (int x = 0; x < static_cast<int>(geometry.width); ++x) {
            if (!geometry::geometry_visible(geometry_, {x + 0.5, y + 0.5})) continue;
            const glm::dvec3 a = towards(x, y), b = towards(x + 1, y), c = towards(x + 1, y + 1), d = towards(x, y + 1);
            direction_[index(x, y)] = towards(x + 0.5, y + 0.5);
            solid_angle_[index(x, y)] = 0.5 * (glm::length(glm::cross(b - a, d - a)) + glm::length(glm::cross(b - c, d - c)));
            smallest_step_ = std::min({smallest_step_, glm::length(b - a), glm::length(d - a)});
            mean_step_ += std::sqrt(glm::length(b - a) * glm::length(d - a));
            ++count;
        }
    mean_step_ /= std::max(count, 1);
    if (geometry_.kind == geometry_equirect) smallest_step_ = mean_step_ = pi / geometry_.height;
}

// Kernel integrated over the source's pixel, where it is near enough for that to matter.
Rgb Scatter::pixel_weight(glm::dvec3 here, int u, int v, int apart, const Kernel& kernel) const {
    const int samples = exact_ ? (apart <= 2 ? 12 : apart <= 10 ? 4 : 1) : (apart <= 2 ? 6 : apart <= 6 ? 2 : 1);
    Rgb sum{};
    for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) {
            const glm::dvec3 there = samples == 1 ? direction(u, v) : towards(u + (i + 0.5) / samples, v + (j + 0.5) / samples);
            const Rgb value = kernel(angle_between(there, here));
            for (std::size_t c = 0; c < 3; ++c) sum[c] += value[c];
        }
    for (double& value : sum) value *= solid_angle_[index(u, v)] / (samples * samples);
    return sum;
}

Rgb Scatter::at(int x, int y, const ImageD& source, const Tree& tree, const Kernel& kernel, bool leaves) const {
    const glm::dvec3 here = direction(x, y);
    const Rgb own = leaves ? Rgb{source.at(x, y, 0), source.at(x, y, 1), source.at(x, y, 2)} : Rgb{};
    const bool nothing_leaves = own[0] == 0 && own[1] == 0 && own[2] == 0;
    Rgb sum{};
    std::vector<int> open{tree.root};
    while (!open.empty()) {
        const int i = open.back();
        open.pop_back();
        if (i < 0) continue;
        const Square& square = tree.squares[static_cast<std::size_t>(i)];
        if (nothing_leaves && square.light[0] == 0 && square.light[1] == 0 && square.light[2] == 0) continue;
        if (square.size == 1) {
            if (square.x == x && square.y == y) continue;
            Rgb difference;
            for (std::size_t c = 0; c < 3; ++c) difference[c] = square.light[c] / square.solid_angle - own[c];
            if (difference[0] == 0 && difference[1] == 0 && difference[2] == 0) continue;
            const Rgb weight = pixel_weight(here, square.x, square.y, std::max(std::abs(square.x - x), std::abs(square.y - y)), kernel);
            for (std::size_t c = 0; c < 3; ++c) sum[c] += weight[c] * difference[c];
            continue;
        }
        const double distance = glm::length(square.centre - here);
        if (exact_ || square.radius > glare_opening * distance || distance < 8 * mean_step_) {
            open.insert(open.end(), square.quarters, square.quarters + 4);
            continue;
        }
        const Rgb arriving = kernel(angle_between(square.light_centre, here)), leaving = nothing_leaves ? Rgb{} : kernel(angle_between(square.centre, here));
        for (std::size_t c = 0; c < 3; ++c) sum[c] += arriving[c] * square.light[c] - leaving[c] * square.solid_angle * own[c];
    }
    return sum;
}

ImageD Scatter::operator()(const ImageD& source, const Kernel& kernel, bool leaves) const {
    ImageD out(source.width, source.height, 3, 0.0);
    const Tree tree(*this, source);
    std::atomic<int> next = 0;
    const auto rows = [&] {
        for (int y = next++; y < source.height; y = next++)
            for (int x = 0; x < source.width; ++x) {
                if (!visible(x, y)) continue;
                const Rgb sum = at(x, y, source, tree, kernel, leaves);
                for (int c = 0; c < 3; ++c) out.at(x, y, c) = sum[static_cast<std::size_t>(c)];
            }
    };
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < std::max(std::thread::hardware_concurrency(), 1u); ++i) threads.emplace_back(rows);
    threads.clear();
    return out;
}

Rgb energy(const std::function<Rgb(double)>& per_sr, double from, double to) {
    Rgb sum{};
    constexpr int steps = 4000;
    for (int i = 0; i < steps; ++i) {
        const double theta = from * std::pow(to / from, (i + 0.5) / steps), width = theta * std::log(to / from) / steps;
        const Rgb value = per_sr(theta);
        for (std::size_t c = 0; c < 3; ++c) sum[c] += value[c] * 2 * pi * std::sin(theta) * width;
    }
    return sum;
}

namespace {

// The light of each primary, alike in all channels, through the kernel that says what a channel gets of it.
ImageD scattered_by_primary(const ImageD& source, const Scatter& scatter, std::span<const Kernel> primaries) {
    ImageD sum(source.width, source.height, 3);
    for (std::size_t primary = 0; primary < 3; ++primary) {
        ImageD light = source;
        for (std::size_t i = 0; i < light.data.size(); ++i) light.data[i] = source.data[i - i % 3 + primary];
        const ImageD added = scatter(light, primaries[primary], false);
        for (std::size_t i = 0; i < sum.data.size(); ++i) sum.data[i] += added.data[i];
    }
    return sum;
}

}  // namespace

ImageD seen(const ImageD& image, const Scatter& scatter, const Kernel& person, const Kernel& wearer, bool differ, double white, double rescatter,
            bool photographic, std::span<const Kernel> primaries) {
    ImageD out = image;
    const auto add = [&](const ImageD& light, double sign) {
        for (std::size_t i = 0; i < out.data.size(); ++i) out.data[i] = std::max(out.data[i] + sign * light.data[i], 0.0);
    };
    if (photographic) {
        add(scatter(image, person, true), 1);
        return out;
    }
    ImageD excess = image, shown = image;
    for (double& v : excess.data) v = std::max(v - white, 0.0);
    for (double& v : shown.data) v = std::min(v, white);
    ImageD added = primaries.empty() ? scatter(excess, person, false) : scattered_by_primary(excess, scatter, primaries);
    if (differ) {
        const ImageD by_person = scatter(shown, person, true), by_wearer = scatter(shown, wearer, true);
        for (std::size_t i = 0; i < added.data.size(); ++i) added.data[i] += by_person.data[i] - by_wearer.data[i];
    }
    add(added, 1);
    ImageD drawn = out;
    for (std::size_t i = 0; i < drawn.data.size(); ++i) drawn.data[i] = std::min(out.data[i], white) - shown.data[i];
    if (rescatter > 0) add(scatter(drawn, wearer, true), -rescatter);
    return out;
}

namespace {

double lobe(double a, double nm, double m, double s1, double s2) { return a * std::exp(-0.5 * std::pow((nm - m) / (nm < m ? s1 : s2), 2)); }
double encircled(double x) { return 1 - std::pow(std::cyl_bessel_j(0.0, x), 2) - std::pow(std::cyl_bessel_j(1.0, x), 2); }

}  // namespace

Rgb linear_rgb(double nm) {
    const double x = lobe(1.056, nm, 599.8, 37.9, 31.0) + lobe(0.362, nm, 442.0, 16.0, 26.7) - lobe(0.065, nm, 501.1, 20.4, 26.2);
    const double y = lobe(0.821, nm, 568.8, 46.9, 40.5) + lobe(0.286, nm, 530.9, 16.3, 31.1);
    const double z = lobe(1.217, nm, 437.0, 11.8, 36.0) + lobe(0.681, nm, 459.0, 26.0, 13.8);
    return {3.2404542 * x - 1.5371385 * y - 0.4985314 * z, -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
            0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
}

std::vector<Wave> white_spectrum() {
    std::vector<Wave> waves;
    Rgb sum{};
    for (int nm = 402; nm < 700; nm += 4) {
        waves.push_back({static_cast<double>(nm), linear_rgb(nm)});
        for (std::size_t c = 0; c < 3; ++c) sum[c] += waves.back().weight[c];
    }
    for (Wave& wave : waves)
        for (std::size_t c = 0; c < 3; ++c) wave.weight[c] /= sum[c];
    return waves;
}

std::vector<Wave> primary_spectrum(std::size_t primary) {
    const auto power = [](int nm) {  // of red, green and blue, linear between the table's rows
        const double place = (nm - emission_first_nm) / emission_step_nm;
        const auto row = static_cast<std::size_t>(place);
        glm::dvec3 value;
        for (int i = 0; i < 3; ++i) value[i] = std::lerp(emission_basis[row][static_cast<std::size_t>(i)], emission_basis[row + 1][static_cast<std::size_t>(i)], place - std::floor(place));
        return value;
    };
    std::vector<Wave> waves = white_spectrum();
    // By Cramer's rule: the mixture of the three spectra that is seen as the primary.
    glm::dmat3 seen_as(0.0);  // column: spectrum
    for (const Wave& wave : waves) {
        const Rgb rgb = linear_rgb(wave.nm);
        seen_as += glm::outerProduct(glm::dvec3(rgb[0], rgb[1], rgb[2]), power(static_cast<int>(wave.nm)));
    }
    glm::dvec3 mixture, wanted(0.0);
    wanted[static_cast<int>(primary)] = 1;
    for (int i = 0; i < 3; ++i) {
        glm::dmat3 replaced = seen_as;
        replaced[i] = wanted;
        mixture[i] = glm::determinant(replaced) / glm::determinant(seen_as);
    }
    for (Wave& wave : waves) {
        const double light = glm::dot(mixture, power(static_cast<int>(wave.nm)));
        const Rgb rgb = linear_rgb(wave.nm);
        for (std::size_t c = 0; c < 3; ++c) wave.weight[c] = rgb[c] * light;
    }
    return waves;
}

double aperture_ring(double aperture_um, double lambda_um, double theta, double least) {
    const double half = std::max(least, lambda_um / aperture_um), inside = std::max(theta - half, 0.0), outside = std::min(theta + half, pi / 2);
    // Beyond x = 200 the fringes' mean 2/(pi x) of 1 - E is exact to 1e-5.
    const auto outside_energy = [&](double angle) {
        const double x = pi * aperture_um * std::sin(angle) / lambda_um;
        return x > 200 ? 2 / (pi * x) : 1 - encircled(x);
    };
    if (outside <= inside + 1e-9) return lambda_um / (pi * pi * pi * aperture_um);
    // Energy is counted per angle^2 as on the plane of sin(theta): d(omega) = 2 pi sin cos dtheta there.
    return (outside_energy(inside) - outside_energy(outside)) / (pi * (std::pow(std::sin(outside), 2) - std::pow(std::sin(inside), 2)));
}

double disc(double diameter_um, double lambda_um, double theta) {
    const double x = pi * diameter_um * std::sin(theta) / lambda_um, peak = pi / 4 * diameter_um * diameter_um / (lambda_um * lambda_um);
    return x < 1e-6 ? peak : peak * std::pow(2 * std::cyl_bessel_j(1.0, x) / x, 2);
}

}  // namespace entoptic::perception::glare_reference
