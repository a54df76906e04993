#include "compositor/eye_view.h"

#include "compositor/lens_math.glsl"

#include <algorithm>
#include <cmath>

namespace entoptic::compositor {
namespace {

// r² of one colour where it shows what lies `radius` (lens coordinates of the undistorted view) from its centre: by bisection, since
// r/(1 + k0 r² + k1 r⁴ + k2 r⁶) grows up to the cut-off.
double r2_at(const LensChannel& channel, double radius, double cutoff) {
    double low = 0, high = std::sqrt(cutoff);
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high), denominator = geometry::lens_denominator(channel, middle * middle);
        (denominator > 0.05 && middle / denominator <= radius ? low : high) = middle;
    }
    return low * low;
}

// The device's cut-off, an r² for all colours, ends each colour at another direction: 4 degrees of blue alone on the example lens. Each is
// cut where the first of them ends.
glm::vec3 common_cutoff(const EyeGeometry& g, double cutoff) {
    double radius = 1e9;
    for (const LensChannel& channel : g.channels) {
        const double denominator = geometry::lens_denominator(channel, cutoff);
        if (denominator > 0.05) radius = std::min(radius, std::sqrt(cutoff) / denominator);
    }
    glm::vec3 r2;
    for (int c = 0; c < 3; ++c) r2[c] = static_cast<float>(r2_at(g.channels[c], radius, cutoff));
    return r2;
}

bool tile_is_shown(const EyeGeometry& g, std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) {
    // The lens shows a disc (or the common part of three with nearly one centre): the pixel nearest to the centre decides.
    const double centre_x = (double(g.channels[1].centre.x) + 1) * 0.5 * g.width;
    const double centre_y = (double(g.channels[1].centre.y) * double(g.aspect) + 1) * 0.5 * g.height;
    const double nearest_x = std::clamp(centre_x, x0 + 0.5, x1 - 0.5), nearest_y = std::clamp(centre_y, y0 + 0.5, y1 - 0.5);
    for (const glm::dvec2 px : {glm::dvec2(nearest_x, nearest_y), glm::dvec2(x0 + 0.5, y0 + 0.5), glm::dvec2(x1 - 0.5, y0 + 0.5),
                                glm::dvec2(x0 + 0.5, y1 - 0.5), glm::dvec2(x1 - 0.5, y1 - 0.5)})
        if (geometry::lens_shows(g, 0, px) || geometry::lens_shows(g, 1, px) || geometry::lens_shows(g, 2, px)) return true;
    return false;
}

}  // namespace

EyeGeometry panel_geometry(const EyeOptics& optics, std::uint32_t width, std::uint32_t height) {
    const Lens& lens = optics.lens;
    EyeGeometry g{};
    g.kind = geometry_lens;
    g.width = width;
    g.height = height;
    g.tan_left = std::tan(optics.fov.angle_left);
    g.tan_right = std::tan(optics.fov.angle_right);
    g.tan_up = std::tan(optics.fov.angle_up);
    g.tan_down = std::tan(optics.fov.angle_down);
    g.aspect = lens.aspect;
    g.focal = lens.focal;
    g.principal_point = lens.principal_point;
    for (std::size_t c = 0; c < 3; ++c) g.channels[c] = {lens.channels[c].centre, lens.channels[c].coefficients};
    g.r2_cutoff = common_cutoff(g, double(lens.r2_cutoff));
    return g;
}

EyeGeometry eye_geometry(const EyeOptics& optics, std::uint32_t width, std::uint32_t height) {
    EyeGeometry g = panel_geometry(optics, width, height);
    g.r2_cutoff *= 1 + 8.0f / static_cast<float>(std::max(width, 1u));  // two pixels more, for the filter at the rim
    return g;
}

bool is_achromatic(const EyeGeometry& g) {
    const auto same = [](const LensChannel& a, const LensChannel& b) { return a.centre == b.centre && a.coefficients == b.coefficients; };
    return same(g.channels[0], g.channels[1]) && same(g.channels[2], g.channels[1]);
}

TileLists tile_lists(const EyeGeometry& g, std::uint32_t tile_w, std::uint32_t tile_h) {
    TileLists lists;
    for (std::uint32_t y = 0; y * tile_h < g.height; ++y) {
        for (std::uint32_t x = 0; x * tile_w < g.width; ++x) {
            const bool shown =
                tile_is_shown(g, x * tile_w, y * tile_h, std::min((x + 1) * tile_w, g.width), std::min((y + 1) * tile_h, g.height));
            (shown ? lists.shown : lists.hidden).push_back(x | y << 16);
        }
    }
    return lists;
}

}  // namespace entoptic::compositor
