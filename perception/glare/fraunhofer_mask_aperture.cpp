#include "perception/glare/fraunhofer_mask_aperture.h"

#include "base/image_io.h"
#include "base/noise.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <glm/glm.hpp>

namespace entoptic::perception {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180;

using glm::dvec2;

// A square of samples and where they are.
struct Plane {
    int n;
    double plane_mm;
    double pitch() const { return plane_mm / n; }
    dvec2 centre(int x, int y) const { return {(x + 0.5 - n / 2.0) * pitch(), -(y + 0.5 - n / 2.0) * pitch()}; }
    // First and last sample that [low, high] mm of x, or of y, may touch.
    int first(double low) const { return std::clamp(static_cast<int>(std::floor(low / pitch() + n / 2.0)) - 1, 0, n); }
    int last(double high) const { return std::clamp(static_cast<int>(std::ceil(high / pitch() + n / 2.0)) + 1, 0, n); }
};

// Of a strip of half width h about a line with this normal.
double strip_coverage(double distance, double half_width, dvec2 normal) {
    return edge_coverage(half_width + distance, normal.x, normal.y) + edge_coverage(half_width - distance, normal.x, normal.y) - 1;
}

double disc_coverage(dvec2 at, double radius, double pitch) {
    const double r = glm::length(at);
    if (r < 1e-9 || r < radius - pitch) return 1;
    return edge_coverage((radius - r) / pitch, at.x / r, at.y / r);
}

double polygon_coverage(dvec2 at, double radius, int sides, double rotation, double pitch) {
    double share = 1;
    const double inner = radius * std::cos(pi / sides);
    for (int k = 0; k < sides; ++k) {
        const double angle = rotation + (2 * k + 1) * pi / sides;
        const dvec2 normal{std::cos(angle), std::sin(angle)};
        share *= edge_coverage((inner - glm::dot(normal, at)) / pitch, normal.x, normal.y);
    }
    return share;
}

double lids_coverage(dvec2 at, const LidEdges& lids, double pitch) {
    const double within = std::min(lids.upper - at.y, at.y - lids.lower) - at.x * at.x / (2 * lid_radius_mm);
    if (within > 2 * pitch) return 1;
    const double slope = at.x / lid_radius_mm, bend = at.x * at.x / (2 * lid_radius_mm), steep = std::sqrt(1 + slope * slope);
    const dvec2 up_normal{slope / steep, 1 / steep};
    const double under = (lids.upper - bend - at.y) / steep, over = (at.y - lids.lower - bend) / steep;
    return edge_coverage(under / pitch, up_normal.x, up_normal.y) * edge_coverage(over / pitch, -up_normal.x, up_normal.y);
}

// Lines of a cross-screen filter: 1 where light passes.
double filter_coverage(dvec2 at, const FraunhoferMaskParams& p, double pitch) {
    double share = 1;
    const int directions = static_cast<int>(std::lround(p.filter_directions));
    const double spacing = static_cast<double>(p.filter_spacing_mm), half = 0.5 * static_cast<double>(p.filter_width_mm);
    for (int k = 0; k < directions; ++k) {
        const double angle = static_cast<double>(p.filter_rotation_deg) * degree + k * pi / directions;
        const dvec2 normal{-std::sin(angle), std::cos(angle)};
        const double d = glm::dot(normal, at);
        const double from_line = d - spacing * std::round(d / spacing);
        share *= 1 - std::clamp(strip_coverage(from_line / pitch, half / pitch, normal), 0.0, 1.0);
    }
    return share;
}

// --- eyelashes ---

// What covers the samples of one lash: a piece from a to b, cut off at each end by the line with that normal. Only where light `passes`.
void draw_strip(const Plane& plane, dvec2 a, dvec2 b, dvec2 cut_a, dvec2 cut_b, double half_width, const ImageD& passes,
                std::vector<double>& opaque, std::vector<int>& touched) {
    const double length = glm::length(b - a), pitch = plane.pitch();
    if (length < 1e-9) return;
    const dvec2 along = (b - a) / length, normal{-along.y, along.x};
    // Beside the piece, and past an end that a turn of half a radian may have cut obliquely.
    const double beside = half_width + 2 * pitch, past = 0.25 * half_width + 2 * pitch;
    const dvec2 box = past * glm::abs(along) + beside * glm::abs(normal), low = glm::min(a, b) - box, high = glm::max(a, b) + box;
    const int x0 = plane.first(low.x), x1 = plane.last(high.x), y0 = plane.first(-high.y), y1 = plane.last(-low.y);
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
            const dvec2 from = plane.centre(x, y) - a;
            const double t = glm::dot(from, along), d = glm::dot(from, normal);
            if (std::abs(d) > beside || t < -past || t > length + past) continue;
            const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(plane.n) + static_cast<std::size_t>(x);
            if (passes.data[at] == 0) continue;
            const double ends = edge_coverage(glm::dot(from, cut_a) / pitch, cut_a.x, cut_a.y) *
                                edge_coverage(glm::dot(b - a - from, cut_b) / pitch, cut_b.x, cut_b.y);
            const double share = std::clamp(strip_coverage(d / pitch, half_width / pitch, normal), 0.0, 1.0) * ends;
            if (share <= 0) continue;
            if (opaque[at] == 0) touched.push_back(static_cast<int>(at));
            // Pieces of one lash share the samples at a joint, each with its own part of them.
            opaque[at] = std::min(opaque[at] + share, 1.0);
        }
}

void draw_lashes(const FraunhoferMaskParams& p, double open, double shift_mm, const Plane& plane, ImageD& passes) {
    constexpr int pieces = 64;
    const double half_width = 0.5 * static_cast<double>(p.lash_width_mm);
    std::vector<double> opaque(passes.data.size(), 0);
    std::vector<int> touched;
    for (const Lash& lash : grow_lashes(p, open, shift_mm)) {
        const int count = lash.curl > 0 ? pieces : 1;
        const auto joint = [&](int k) { return lash.at(static_cast<double>(k) / count); };
        const auto along = [&](int k) { return glm::normalize(joint(k + 1) - joint(k)); };
        // Pieces meet at the line that halves the angle between them: neither a gap nor an overlap.
        const auto cut = [&](int k) { return glm::normalize(along(std::max(k - 1, 0)) + along(std::min(k, count - 1))); };
        for (int k = 0; k < count; ++k) draw_strip(plane, joint(k), joint(k + 1), cut(k), cut(k + 1), half_width, passes, opaque, touched);
        for (const int i : touched) {
            passes.data[static_cast<std::size_t>(i)] *= 1 - opaque[static_cast<std::size_t>(i)];
            opaque[static_cast<std::size_t>(i)] = 0;
        }
        touched.clear();
    }
}

// --- pictures ---

struct Tap {
    int from;
    double weight;
};
// Mean of a row of cells over each of n intervals; cells go on past both ends.
std::vector<std::vector<Tap>> box_taps(int n, double first_cell, double cells_a_sample, int cells) {
    std::vector<std::vector<Tap>> taps(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) {
        const double low = first_cell + i * cells_a_sample, high = low + cells_a_sample;
        auto& list = taps[static_cast<std::size_t>(i)];
        if (high <= 1 || low >= cells - 1) {
            list.push_back({high <= 1 ? 0 : cells - 1, 1});
            continue;
        }
        for (int c = static_cast<int>(std::floor(low)); c < high; ++c) {
            const double part = std::min(high, c + 1.0) - std::max(low, static_cast<double>(c));
            if (part > 0) list.push_back({std::clamp(c, 0, cells - 1), part / cells_a_sample});
        }
    }
    return taps;
}

// The picture's mean, and that of its square, over each sample.
void draw_picture(const ImageD& picture, double width_mm, double shift_mm, const Plane& plane, ImageD& mean, ImageD& mean_square) {
    const double cell = width_mm / picture.width, a_sample = plane.pitch() / cell;
    const double left = (-plane.plane_mm / 2 - shift_mm) / cell + picture.width / 2.0,
                 top = -plane.plane_mm / 2 / cell + picture.height / 2.0;
    const auto across = box_taps(plane.n, left, a_sample, picture.width), down = box_taps(plane.n, top, a_sample, picture.height);
    ImageD row_mean(plane.n, picture.height, 2);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < plane.n; ++x)
            for (const Tap& tap : across[static_cast<std::size_t>(x)]) {
                const double t = picture.at(tap.from, y, 0);
                row_mean.at(x, y, 0) += tap.weight * t;
                row_mean.at(x, y, 1) += tap.weight * t * t;
            }
    for (int y = 0; y < plane.n; ++y)
        for (int x = 0; x < plane.n; ++x)
            for (const Tap& tap : down[static_cast<std::size_t>(y)]) {
                mean.at(x, y, 0) += tap.weight * row_mean.at(x, tap.from, 0);
                mean_square.at(x, y, 0) += tap.weight * row_mean.at(x, tap.from, 1);
            }
}

}  // namespace

Result<std::shared_ptr<const MaskPicture>> read_mask_picture(const std::string& path) {
    constexpr double tolerance = 1e-3;  // choice: what resampling leaves beyond the range
    auto picture = std::make_shared<MaskPicture>();
    const auto lower_ending = [&](std::size_t n) {
        std::string end = path.size() >= n ? path.substr(path.size() - n) : "";
        for (char& c : end) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        return end;
    };
    if (lower_ending(4) == ".exr") {
        ENTOPTIC_TRY(exr, read_exr(path));
        picture->transmission = ImageD(exr.rgb.width, exr.rgb.height, 1);
        for (std::size_t i = 0; i < picture->transmission.data.size(); ++i) {
            const float* c = &exr.rgb.data[3 * i];
            const double y = 0.2126 * static_cast<double>(c[0]) + 0.7152 * static_cast<double>(c[1]) + 0.0722 * static_cast<double>(c[2]);
            if (!(y >= -tolerance && y <= 1 + tolerance))
                return usage_error(fmt::format("'{}': the pixel {}, {} is {}; a mask's values are transmissions of amplitude, 0 (opaque) to 1 (clear).", path,
                                               i % static_cast<std::size_t>(exr.rgb.width), i / static_cast<std::size_t>(exr.rgb.width), y));
            picture->transmission.data[i] = std::clamp(y, 0.0, 1.0);
        }
    } else if (lower_ending(4) == ".png") {
        ENTOPTIC_TRY(png, read_png(path));
        picture->transmission = ImageD(png.width, png.height, 1);
        const auto n = static_cast<std::size_t>(png.channels);
        for (std::size_t i = 0; i < picture->transmission.data.size(); ++i) {
            const std::uint8_t* c = &png.data[n * i];
            const double grey = n >= 3 ? (0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]) / 255 : c[0] / 255.0;
            picture->transmission.data[i] = grey * (n == 2 || n == 4 ? c[n - 1] / 255.0 : 1.0);
        }
    } else {
        return usage_error(fmt::format("'{}' is no picture of an aperture: a .png or .exr file is needed.", path));
    }
    if (std::all_of(picture->transmission.data.begin(), picture->transmission.data.end(), [](double t) { return t <= 0; }))
        return usage_error(fmt::format("'{}' lets no light through: it is black, or transparent, everywhere. White is clear, black opaque.", path));
    if (picture->transmission.width > 16384 || picture->transmission.height > 16384)
        return usage_error(fmt::format("'{}' is {}x{} pixels: an aperture may have 1 to 16384 a side.", path, picture->transmission.width,
                                       picture->transmission.height));
    return std::shared_ptr<const MaskPicture>(std::move(picture));
}

// The inside of the edge covers all projections of the square onto the normal up to `distance`. A uniform square projects to a trapezoid.
double edge_coverage(double distance, double x, double y) {
    const double a = std::max(std::abs(x), std::abs(y)), b = std::min(std::abs(x), std::abs(y));
    if (distance >= 0.5 * (a + b)) return 1;
    if (distance <= -0.5 * (a + b)) return 0;
    if (b < 1e-7) return std::clamp(0.5 + distance / a, 0.0, 1.0);
    const auto ramp = [](double t) { return t > 0 ? t * t : 0.0; };
    const double sum = 0.5 * (a + b), difference = 0.5 * (a - b);
    return (ramp(distance + sum) - ramp(distance + difference) - ramp(distance - difference) + ramp(distance - sum)) / (2 * a * b);
}

// choice: an opening of 11 mm that closes 4 mm below the pupil's centre, most of it by the upper lid.
LidEdges lid_edges(double open) {
    const double o = std::clamp(open, 0.0, 1.0);
    return {-4 + 9.5 * o, -4 - 1.5 * o};
}

// Lashes stand on the whole lid, 30 mm wide, so that light from the side meets others. choice: they spread like a fan, and differ a little.
// They turn up with the lid that lifts them: of an open eye they only touch a wide pupil.
std::vector<Lash> grow_lashes(const FraunhoferMaskParams& p, double open, double shift_mm) {
    std::vector<Lash> list;
    const LidEdges lids = lid_edges(open);
    const double curl = glm::mix(static_cast<double>(p.lash_curl), 1.0, std::clamp(open, 0.0, 1.0));
    const double spacing = 10 / static_cast<double>(p.lashes);
    const auto seed = static_cast<std::uint64_t>(std::llround(std::max(p.lash_seed, 0.0f)));
    for (int i = static_cast<int>(std::ceil(-15 / spacing)); i * spacing <= 15; ++i) {
        const auto random = [&](std::uint64_t k) { return uniform01(seed, static_cast<std::uint64_t>(i + 100000) * 4 + k); };
        const double x = (i + random(0) - 0.5) * spacing;
        const double lean = 0.04 * x + 0.25 * (random(1) - 0.5);
        Lash lash;
        lash.root = {x + shift_mm, lids.upper - x * x / (2 * lid_radius_mm)};
        lash.down = {std::sin(lean), -std::cos(lean)};
        lash.across = {std::cos(lean), std::sin(lean)};
        if (lean < 0) lash.across = -lash.across;
        lash.length = static_cast<double>(p.lash_length_mm) * (0.8 + 0.4 * random(2));
        lash.curl = curl * (0.85 + 0.15 * random(3));
        list.push_back(lash);
    }
    return list;
}

ApertureRaster raster_aperture(const FraunhoferMaskParams& p, const MaskPicture* picture, const ApertureState& state, int n,
                               double plane_mm) {
    const Plane plane{n, plane_mm};
    const double pitch = plane.pitch(), radius = 0.5 * state.pupil_mm, shift = state.obstacle_shift_mm;
    const int blades = static_cast<int>(std::lround(p.blades));
    const double open = state.eyelid_open * static_cast<double>(p.lid_open);
    const LidEdges lids = lid_edges(open);
    ApertureRaster out{n, plane_mm, ImageD(n, n, 1), 0};
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const dvec2 at = plane.centre(x, y);
            if (glm::length(at) > radius + pitch) continue;
            double share = blades >= 3 ? polygon_coverage(at, radius, blades, static_cast<double>(p.blade_rotation_deg) * degree, pitch)
                                       : disc_coverage(at, radius, pitch);
            const dvec2 obstacle = at - dvec2(shift, 0);
            if (share > 0 && p.lids > 0.5f) share *= lids_coverage(at - dvec2(lid_shift_mm(p, shift), 0), lids, pitch);
            if (share > 0 && p.filter_directions >= 0.5f) share *= filter_coverage(obstacle, p, pitch);
            out.amplitude.at(x, y, 0) = share;
        }
    if (p.lashes >= 0.5f) draw_lashes(p, open, shift, plane, out.amplitude);
    if (picture) {
        ImageD mean(n, n, 1), square(n, n, 1);
        draw_picture(picture->transmission, static_cast<double>(p.mask_width_mm), shift, plane, mean, square);
        for (std::size_t i = 0; i < mean.data.size(); ++i) {
            out.passed += out.amplitude.data[i] * square.data[i];
            out.amplitude.data[i] *= mean.data[i];
        }
    } else {
        for (const double share : out.amplitude.data) out.passed += share;
    }
    return out;
}

}  // namespace entoptic::perception
