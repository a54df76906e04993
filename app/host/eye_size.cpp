#include "app/host/eye_size.h"

#include "compositor/eye_view.h"
#include "shaders/geometry.glsl"

#include <algorithm>
#include <cmath>

namespace entoptic::app {
namespace {

using geometry::rvec2;

// Pixels that `tangents` of field (right, up) would have at the density of the lens's centre.
rvec2 size_at_centre_density(const EyeGeometry& g, rvec2 tangents) {
    const LensChannel& green = g.channels[1];
    const rvec2 centre = geometry::lens_pixel(g, green, rvec2(0));
    const rvec2 across =
        geometry::lens_tangents(g, green, centre + rvec2(0.5, 0)) - geometry::lens_tangents(g, green, centre - rvec2(0.5, 0));
    const rvec2 down =
        geometry::lens_tangents(g, green, centre + rvec2(0, 0.5)) - geometry::lens_tangents(g, green, centre - rvec2(0, 0.5));
    return {tangents.x / std::abs(across.x), tangents.y / std::abs(down.y)};
}

std::uint32_t even(double pixels) { return static_cast<std::uint32_t>(std::max(2.0, 2 * std::round(pixels / 2))); }

}  // namespace

EyeSize recommended_eye_size(const Headset& headset, double scale) {
    rvec2 size(0);
    for (const EyeOptics& eye : headset.eyes) {
        const EyeGeometry g = compositor::panel_geometry(eye, static_cast<std::uint32_t>(headset.display.panel_width),
                                                         static_cast<std::uint32_t>(headset.display.panel_height));
        const auto tan = [](float angle) { return std::tan(static_cast<double>(angle)); };
        size = glm::max(size, size_at_centre_density(g, {tan(eye.fov.angle_right) - tan(eye.fov.angle_left),
                                                         tan(eye.fov.angle_up) - tan(eye.fov.angle_down)}));
    }
    return {even(size.x * scale), even(size.y * scale)};
}

}  // namespace entoptic::app
