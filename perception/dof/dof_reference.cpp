#include "perception/dof/dof_reference.h"

#include "shaders/geometry.glsl"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

namespace entoptic::perception {
namespace {

glm::dvec3 direction(const EyeGeometry& g, double x, double y) { return geometry::geometry_direction(g, {x, y}); }

// Median distance of all pixels within half a degree of the gaze; negative when none is known.
double distance_at_gaze(const ReferenceFrame& frame) {
    std::vector<double> known;
    const glm::dvec3 gaze = glm::normalize(glm::dvec3(frame.eye.gaze_direction));
    for (int y = 0; y < frame.dioptre.height; ++y)
        for (int x = 0; x < frame.dioptre.width; ++x) {
            const double angle = std::acos(std::min(1.0, glm::dot(direction(frame.geometry, x + 0.5, y + 0.5), gaze)));
            if (angle <= 0.5 * std::numbers::pi / 180 && frame.dioptre.at(x, y, 0) >= 0) known.push_back(frame.dioptre.at(x, y, 0));
        }
    if (known.empty()) return -1;
    std::ranges::nth_element(known, known.begin() + static_cast<std::ptrdiff_t>((known.size() - 1) / 2));
    return known[(known.size() - 1) / 2];
}

// Area of the disc of `radius` around the origin within the pixel centred on (x, y), of the disc's whole area. Rim pixels are counted out
// on 16x16 points.
double overlap(double radius, int x, int y) {
    if (radius <= 0.5) return x == 0 && y == 0;
    const double far = std::hypot(std::abs(x) + 0.5, std::abs(y) + 0.5);
    const double near = std::hypot(std::max(0.0, std::abs(x) - 0.5), std::max(0.0, std::abs(y) - 0.5));
    const double area = std::numbers::pi * radius * radius;
    if (far <= radius) return 1 / area;
    if (near >= radius) return 0;
    int inside = 0;
    for (int j = 0; j < 16; ++j)
        for (int i = 0; i < 16; ++i) inside += std::hypot(x + (i - 7.5) / 16, y + (j - 7.5) / 16) <= radius;
    return inside / 256.0 / area;
}

// Liu et al. 2021, section 3.3.2: which colours the row of a kernel of `rows` rows above and below its centre passes. Beyond the depth of
// field "the top 2 rows of kernel filter out blue, and the bottom 2 rows of kernel filter out red. The other way around" in front of it.
bool passes(int colour, int row, int rows, int side) {
    const bool top = row <= -rows + 1, bottom = row >= rows - 1;
    if (side == 0 || colour == 1) return true;
    return (colour == 2) == (side < 0) ? !top : !bottom;
}

// Share of the disc that the rows which pass it hold.
double passed(double radius, int rows, int colour, int side) {
    static thread_local std::map<std::tuple<double, int, int>, double> known;  // few radii occur often
    const auto [entry, is_new] = known.try_emplace({radius, colour, side}, 0);
    for (int j = -rows - 1; is_new && j <= rows + 1; ++j)
        for (int i = -rows - 1; i <= rows + 1; ++i)
            if (passes(colour, j, rows, side)) entry->second += overlap(radius, i, j);
    return entry->second;
}

double share(double radius, int x, int y, int colour, int side) {
    const double plain = overlap(radius, x, y);
    if (side == 0 || colour == 1 || radius <= 0.5) return plain;
    const int rows = static_cast<int>(std::floor(radius + 0.5));
    return passes(colour, y, rows, side) && plain > 0 ? plain / passed(radius, rows, colour, side) : 0;
}

struct Light {
    double front = 0, front_share = 0, behind = 0, behind_share = 0;
};

}  // namespace

bool follow_focus(ReferenceFrame& frame, double fixed_dioptre, bool use_vergence, double tau_s) {
    if (fixed_dioptre >= 0) {
        frame.focus_dioptre = fixed_dioptre;
        return true;
    }
    const bool vergence = use_vergence && frame.vergence_dioptre >= 0;
    const double target = vergence ? std::min(frame.vergence_dioptre, 20.0) : distance_at_gaze(frame);
    if (target < 0) return frame.focus_dioptre >= 0;
    const double kept = frame.snap || frame.focus_dioptre < 0 ? 0 : frame.dt_s > 0 ? std::exp(-frame.dt_s / tau_s) : 1;
    frame.focus_dioptre = kept == 0 ? target : target + (frame.focus_dioptre - target) * kept;
    return true;
}

void scatter(ReferenceFrame& frame, const std::function<ReferenceDisc(double, double)>& disc_of, bool coloured_rows) {
    const int width = frame.image.width, height = frame.image.height;
    std::vector<ReferenceDisc> discs(std::size_t(width) * std::size_t(height));
    const auto at = [&](int x, int y) { return std::size_t(y) * std::size_t(width) + std::size_t(x); };
    const auto visible = [&](int x, int y) { return geometry::geometry_visible(frame.geometry, {x + 0.5, y + 0.5}); };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            ReferenceDisc& disc = discs[at(x, y)];
            disc.dioptre = frame.focus_dioptre;
            const double d = frame.dioptre.at(x, y, 0);
            if (d >= 0) disc = disc_of(d, std::sqrt(geometry::geometry_solid_angle(frame.geometry, {x + 0.5, y + 0.5})));
        }
    const bool wraps = frame.geometry.kind == geometry_equirect;
    for (int colour = 0; colour < 3; ++colour) {
        std::vector<Light> sums(discs.size());
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                if (!visible(x, y)) continue;
                const ReferenceDisc& from = discs[at(x, y)];
                const int reach = static_cast<int>(std::ceil(from.radius_px[colour] + 0.5));
                for (int j = -reach; j <= reach; ++j)
                    for (int i = -reach; i <= reach; ++i) {
                        const int to_x = wraps ? (x + i + width) % width : x + i, to_y = y + j;
                        if (to_x < 0 || to_y < 0 || to_x >= width || to_y >= height) continue;
                        const ReferenceDisc& to = discs[at(to_x, to_y)];
                        const bool covers = from.dioptre > to.dioptre;
                        const double radius = covers ? from.radius_px[colour] : std::min(from.radius_px[colour], to.radius_px[colour]);
                        // A kernel's top row brings light from above: it goes down.
                        const double s = share(radius, i, -j, colour, coloured_rows ? from.side : 0);
                        Light& sum = sums[at(to_x, to_y)];
                        (covers ? sum.front : sum.behind) += s * frame.image.at(x, y, colour);
                        (covers ? sum.front_share : sum.behind_share) += s;
                    }
            }
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                if (!visible(x, y)) continue;
                const Light& sum = sums[at(x, y)];
                const double behind = sum.behind_share > 0 ? sum.behind / sum.behind_share : 0;
                frame.image.at(x, y, colour) = sum.front / std::max(1.0, sum.front_share) + std::max(0.0, 1 - sum.front_share) * behind;
            }
    }
}

}  // namespace entoptic::perception
