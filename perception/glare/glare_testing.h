// For the tests of glare models: a stage with a pupil and an adaptation, lamps, veils, and the engine's algorithm in double. Header-only.
#pragma once

#include "perception/glare/glare_engine.h"
#include "perception/glare/glare_math.glsl"
#include "perception/glare/glare_split.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"
#include "shaders/geometry.glsl"

#include <complex>
#include <fftw3.h>
#include <map>

namespace entoptic::perception::testing {

constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180;

// A stage with glare, an adaptation and a pupil.
class Glare {
public:
    Glare(EyeGeometry geometry, Selection selection, float adaptation = 1, std::size_t views = 1)
        : runner_(std::vector<EyeGeometry>(views, geometry), std::move(selection)), views_(views), adaptation_(adaptation) {}
    ImageF at(const ImageF& picture, float pupil_mm = 4) { return at(std::vector<ImageF>(views_, picture), pupil_mm)[0]; }
    std::vector<ImageF> at(const std::vector<ImageF>& pictures, float pupil_mm = 4) {
        FrameInput input = still_input(views_);
        for (EyeInput& eye : input.eyes) eye.pupil_diameter_mm = pupil_mm;
        runner_.stage().set_adaptation(adaptation_);
        auto out = runner_.run(pictures, input);
        for (const EffectOutcome& outcome : runner_.stage().effects()) EXPECT_EQ(outcome.failed, "");
        return out;
    }
    EffectOutcome outcome() { return runner_.stage().effects().at(0); }

private:
    StageRunner runner_;
    std::size_t views_;
    float adaptation_;
};

inline void fill(ImageF& image, int x0, int y0, int w, int h, float r, float g, float b) {
    for (int y = y0; y < y0 + h; ++y)
        for (int x = x0; x < x0 + w; ++x) image.at(x, y, 0) = r, image.at(x, y, 1) = g, image.at(x, y, 2) = b;
}
inline void fill(ImageF& image, int x0, int y0, int w, int h, float v) { fill(image, x0, y0, w, h, v, v, v); }

// 9.6 pixels per degree on the axis, as the middle of a headset: grid at 4 pixels a texel and near field both at work.
inline EyeGeometry native() { return rectilinear(96, 80, 10); }
// A wide field at low resolution.
inline EyeGeometry wide() { return rectilinear(180, 200, 100); }

inline double energy(const ImageF& image, const EyeGeometry& g, int channel) {
    double sum = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (geometry::geometry_visible(g, {x + 0.5, y + 0.5})) sum += static_cast<double>(image.at(x, y, channel)) * geometry::geometry_solid_angle(g, {x + 0.5, y + 0.5});
    return sum;
}

// Mean veil around a lamp of one pixel in the middle of a flat picture, per lx.
struct Ring { double mean[3], deviation; };
inline Ring ring_around(const ImageF& out, const EyeGeometry& g, int lx, int ly, double lamp, double deg) {
    const double illuminance = lamp * geometry::geometry_solid_angle(g, {lx + 0.5, ly + 0.5});
    const glm::dvec3 axis = geometry::geometry_direction(g, {lx + 0.5, ly + 0.5});
    const glm::dvec3 right = glm::normalize(glm::cross(axis, glm::dvec3(0, 1, 0))), up = glm::cross(right, axis);
    Ring ring{};
    double squares = 0;
    constexpr int n = 360;
    for (int i = 0; i < n; ++i) {
        const double phi = 2 * pi * i / n, theta = deg * degree;
        const glm::dvec2 at = geometry::geometry_pixel(g, std::cos(theta) * axis + std::sin(theta) * (std::cos(phi) * right + std::sin(phi) * up)) - 0.5;
        const int x = static_cast<int>(std::floor(at.x)), y = static_cast<int>(std::floor(at.y));
        for (int c = 0; c < 3; ++c) {
            const auto tap = [&](int dx, int dy) { return static_cast<double>(out.at(x + dx, y + dy, c)); };
            const double v = glm::mix(glm::mix(tap(0, 0), tap(1, 0), at.x - x), glm::mix(tap(0, 1), tap(1, 1), at.x - x), at.y - y) / illuminance;
            ring.mean[c] += v / n;
            if (c == 1) squares += v * v / n;
        }
    }
    ring.deviation = std::sqrt(std::max(squares - ring.mean[1] * ring.mean[1], 0.0)) / ring.mean[1];
    return ring;
}

using Plane = std::vector<std::complex<double>>;    // square
inline void fftw(Plane& plane, int sign) {
    const int n = static_cast<int>(std::lround(std::sqrt(plane.size())));
    auto* data = reinterpret_cast<fftw_complex*>(plane.data());
    const fftw_plan plan = fftw_plan_dft_2d(n, n, data, data, sign, FFTW_ESTIMATE);
    fftw_execute(plan);
    fftw_destroy_plan(plan);
}

// The engine's algorithm in double, with FFTW: same grid, one view.
class GlareTwin {
public:
    using Kernel = std::function<glm::dvec3(double theta)>;     // per sr

    GlareTwin(const EyeGeometry& g, double texel_px, double near_px) : g_(g), grid_(make_glare_grid(std::span(&g, 1), texel_px)), near_px_(near_px) {}

    // Sum of the far part of K (source(y) - source(x)), or of K source(y). `near`: the kernel is less its near field.
    ImageD far(const ImageD& source, const Kernel& kernel, bool near, bool leaves) const {
        ImageD out(source.width, source.height, 3), ones(source.width, source.height, 1, 1.0);
        for (int c = 0; c < 3; ++c) {
            ImageD channel(source.width, source.height, 1);
            for (int y = 0; y < source.height; ++y)
                for (int x = 0; x < source.width; ++x) channel.at(x, y, 0) = source.at(x, y, c);
            const Plane spectrum = spectrum_of(kernel, c, near);
            const ImageD arrives = veil(channel, spectrum), left = leaves ? veil(ones, spectrum) : ImageD(source.width, source.height, 1, 0.0);
            for (int y = 0; y < source.height; ++y)
                for (int x = 0; x < source.width; ++x) out.at(x, y, c) = arrives.at(x, y, 0) - left.at(x, y, 0) * source.at(x, y, c);
        }
        return out;
    }
    // The near part.
    ImageD near(const ImageD& in, const Kernel& kernel, bool leaves) const {
        ImageD out(in.width, in.height, 3, 0.0);
        const auto [near_rad, capped] = near_field(kernel, true);
        const FarPart smooth(kernel, near_rad, capped);
        for (int ty = 0; ty < in.height; ty += tile_height)
            for (int tx = 0; tx < in.width; tx += tile_width) {
                const glm::dvec2 middle = glm::min(glm::dvec2(tx + tile_width * 0.5, ty + tile_height * 0.5), glm::dvec2(in.width - 0.5, in.height - 0.5));
                const auto towards = [&](double dx, double dy) { return geometry::geometry_direction(g_, middle + glm::dvec2(dx, dy)); };
                const glm::dvec3 across = (towards(2, 0) - towards(-2, 0)) * 0.25, down = (towards(0, 2) - towards(0, -2)) * 0.25;
                const int radius = static_cast<int>(std::clamp(std::ceil(near_rad / std::min(glm::length(across), glm::length(down))), 1.0, double(max_near_px)));
                std::vector<glm::dvec3> weights;
                for (int dy = -radius; dy <= radius; ++dy)
                    for (int dx = -radius; dx <= radius; ++dx) {
                        const int distance = std::max(std::abs(dx), std::abs(dy)), n = distance <= 1 ? 8 : distance <= 2 ? 4 : distance <= 4 ? 3 : 2;
                        glm::dvec3 sum{0};
                        for (int j = 0; j < n && (dx || dy); ++j)
                            for (int i = 0; i < n; ++i) {
                                const double theta = glm::length((dx + (i + 0.5) / n - 0.5) * across + (dy + (j + 0.5) / n - 0.5) * down);
                                sum += kernel(theta) - smooth(theta, kernel(theta));
                            }
                        weights.push_back(sum * (glm::length(glm::cross(across, down)) / (n * n)));
                    }
                for (int y = ty; y < std::min<int>(ty + tile_height, in.height); ++y)
                    for (int x = tx; x < std::min<int>(tx + tile_width, in.width); ++x)
                        for (int dy = -radius; dy <= radius; ++dy)
                            for (int dx = -radius; dx <= radius; ++dx) {
                                if (x + dx < 0 || y + dy < 0 || x + dx >= in.width || y + dy >= in.height) continue;
                                const glm::dvec3 w = weights[static_cast<std::size_t>((dy + radius) * (2 * radius + 1) + dx + radius)];
                                for (int c = 0; c < 3; ++c)
                                    out.at(x, y, c) += w[c] * (in.at(x + dx, y + dy, c) - (leaves ? in.at(x, y, c) : 0.0));
                            }
            }
        return out;
    }
private:
    struct NearField {
        double rad;
        bool capped;
    };
    NearField near_field(const Kernel& kernel, bool near) const {
        const double widest = std::max(near ? std::floor(near_px_) * grid_.pixel_rad : 0.0, 0.5 * grid_.pitch);
        const double reach = near ? FarPart::reach(kernel, widest, grid_.pitch) : 0;
        return {reach > 0 ? reach : widest, reach > 0};
    }
    Plane spectrum_of(const Kernel& kernel, int c, bool near) const {
        const auto [within, capped] = near_field(kernel, near);
        const FarPart smooth(kernel, within, capped);
        Plane plane(grid_.n * grid_.n);
        const int half = static_cast<int>(grid_.n) / 2;
        for (int y = -half; y < half; ++y)
            for (int x = -half; x < half; ++x) {
                const int far = std::max(std::abs(x), std::abs(y)), n = far <= 4 ? 8 : far <= 16 ? 4 : far <= 64 ? 2 : 1;
                double sum = 0;
                for (int j = 0; j < n; ++j)
                    for (int i = 0; i < n; ++i) {
                        const double theta = std::hypot(x + (i + 0.5) / n - 0.5, y + (j + 0.5) / n - 0.5) * grid_.pitch;
                        sum += smooth(theta, kernel(theta))[c];
                    }
                plane[static_cast<std::size_t>((y + 2 * half) % (2 * half) * 2 * half + (x + 2 * half) % (2 * half))] = sum / (n * n);
            }
        fftw(plane, FFTW_FORWARD);
        const Sharpening sharpening = sharpening_for(within, grid_.pitch, grid_.damping, capped, true);
        const auto sharpened = [&](std::size_t i) { return glare::sharpening(static_cast<double>(i) / grid_.n, sharpening.damping, sharpening.order); };
        for (std::size_t i = 0; i < plane.size(); ++i) plane[i] *= sharpened(i % grid_.n) * sharpened(i / grid_.n);
        return plane;
    }
    // Node n stands on pixel step (n - 1). Calls f(node, weight) for every node that the pixel shares light with.
    template <class F> void for_nodes(int x, int y, F f) const {
        const int step = static_cast<int>(grid_.step);
        for (int j = y / step - 1; j <= y / step + 4; ++j)
            for (int i = x / step - 1; i <= x / step + 4; ++i) {
                const double w = glare::spline(static_cast<double>(x) / step - (i - 1)) * glare::spline(static_cast<double>(y) / step - (j - 1));
                if (w > 0 && i >= 0 && j >= 0) f(static_cast<std::size_t>(j) * grid_.nodes_x + static_cast<std::size_t>(i), w);
            }
    }
    // Pixels -> nodes -> texels, convolution, and back.
    ImageD veil(const ImageD& image, const Plane& spectrum) const {
        std::vector<double> nodes(grid_.nodes_x * grid_.nodes_y);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                const double light = image.at(x, y, 0) * geometry::geometry_solid_angle(g_, {x + 0.5, y + 0.5});
                for_nodes(x, y, [&](std::size_t node, double w) { nodes[node] += w * light; });
            }
        Plane plane(grid_.n * grid_.n);
        for (std::size_t t = 0; t < plane.size(); ++t) {
            const std::size_t list = t / grid_.n * glare_n + t % grid_.n;
            for (uint e = grid_.splat_offsets[list]; e < grid_.splat_offsets[list + 1]; ++e)
                plane[t] += static_cast<double>(grid_.splat_entries[e].weight) * nodes[grid_.splat_entries[e].node];
        }
        fftw(plane, FFTW_FORWARD);
        for (std::size_t t = 0; t < plane.size(); ++t) plane[t] *= spectrum[t] / static_cast<double>(plane.size());
        fftw(plane, FFTW_BACKWARD);
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            const NodeTap& tap = grid_.node_taps[n];
            const auto x = static_cast<uint>(tap.u + 0.5f), y = static_cast<uint>(tap.v + 0.5f);
            const glm::dvec3 across = glare::spline_weights(static_cast<double>(tap.u) - x), down = glare::spline_weights(static_cast<double>(tap.v) - y);
            nodes[n] = 0;
            for (uint k = 0; k < 9; ++k)
                nodes[n] += across[static_cast<int>(k % 3)] * down[static_cast<int>(k / 3)] * plane[(y + k / 3 - 1) * grid_.n + x + k % 3 - 1].real();
        }
        ImageD out(image.width, image.height, 1);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) for_nodes(x, y, [&](std::size_t node, double w) { out.at(x, y, 0) += w * nodes[node]; });
        return out;
    }
    EyeGeometry g_;
    GlareGrid grid_;
    double near_px_;
};

inline ImageD plus(const ImageD& a, const ImageD& b, double times = 1) {
    ImageD sum = a;
    for (std::size_t i = 0; i < sum.data.size(); ++i) sum.data[i] += times * b.data[i];
    return sum;
}

}  // namespace entoptic::perception::testing
