#include "compositor/eye_view.h"

#include "compositor/lens_math.glsl"

#include <algorithm>
#include <cmath>

namespace entoptic::compositor {
namespace {

// Largest r² of green, in lens coordinates, of a direction that the rim of the panel shows in any colour.
double rim_r2(const EyeGeometry& panel) {
    const LensChannel& green = panel.channels[1];
    const double radius = std::sqrt(double(panel.r2_cutoff));
    double r2 = panel.r2_cutoff;
    for (int step = 0; step < 64; ++step) {
        const double angle = step * 6.283185307179586 / 64;
        const glm::dvec2 at(radius * std::cos(angle) + double(green.centre.x),
                            (radius * std::sin(angle) + double(green.centre.y)) * double(panel.aspect));
        const glm::dvec2 px = (at * 0.5 + 0.5) * glm::dvec2(panel.width, panel.height);
        for (const LensChannel& channel : {panel.channels[0], panel.channels[2]}) {
            const glm::dvec2 p = geometry::lens_position(panel, green, lens_math::green_pixel_of_colour(panel, channel, px));
            if (std::isfinite(p.x) && std::isfinite(p.y)) r2 = std::max(r2, glm::dot(p, p));
        }
    }
    return std::min(r2, 1.2 * double(panel.r2_cutoff));
}

bool tile_is_shown(const EyeGeometry& g, std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) {
    // The lens shows a disc (or the common part of three with nearly one centre): the pixel nearest to the centre decides.
    const double centre_x = (double(g.channels[1].centre.x) + 1) * 0.5 * g.width;
    const double centre_y = (double(g.channels[1].centre.y) * double(g.aspect) + 1) * 0.5 * g.height;
    const double nearest_x = std::clamp(centre_x, x0 + 0.5, x1 - 0.5), nearest_y = std::clamp(centre_y, y0 + 0.5, y1 - 0.5);
    for (const glm::dvec2 px : {glm::dvec2(nearest_x, nearest_y), glm::dvec2(x0 + 0.5, y0 + 0.5), glm::dvec2(x1 - 0.5, y0 + 0.5),
                                glm::dvec2(x0 + 0.5, y1 - 0.5), glm::dvec2(x1 - 0.5, y1 - 0.5)})
        if (geometry::lens_visible(g, px)) return true;
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
    g.r2_cutoff = lens.r2_cutoff;
    g.focal = lens.focal;
    g.principal_point = lens.principal_point;
    for (std::size_t c = 0; c < 3; ++c) g.channels[c] = {lens.channels[c].centre, lens.channels[c].coefficients};
    return g;
}

EyeGeometry eye_geometry(const EyeOptics& optics, std::uint32_t width, std::uint32_t height) {
    EyeGeometry g = panel_geometry(optics, width, height);
    g.r2_cutoff = static_cast<float>(rim_r2(g) * (1 + 8.0 / std::max(width, 1u)));  // and two pixels for the filter
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
