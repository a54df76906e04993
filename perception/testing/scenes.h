// For tests and benches: pictures of known light, and the geometry of a real headset's lens. Header-only.
#pragma once

#include "base/image.h"
#include "shaders/eye_geometry.h"
#include "shaders/geometry.glsl"

#include <cmath>
#include <cstdint>

namespace entoptic::perception::testing {

inline ImageF uniform(int width, int height, float r, float g, float b) {
    ImageF image(width, height, 3);
    for (std::size_t i = 0; i < image.data.size(); i += 3) image.data[i] = r, image.data[i + 1] = g, image.data[i + 2] = b;
    return image;
}
inline ImageF uniform(int width, int height, float y) { return uniform(width, height, y, y, y); }

// Left and right swapped.
inline ImageF mirrored(const ImageF& in) {
    ImageF out = in;
    for (int y = 0; y < in.height; ++y)
        for (int x = 0; x < in.width; ++x)
            for (int c = 0; c < 3; ++c) out.at(x, y, c) = in.at(in.width - 1 - x, y, c);
    return out;
}

// A coloured picture of median luminance `y`: large shapes, texture of 4 pixels, fine noise, over about a factor of 100, and lamps.
inline ImageF textured(int width, int height, double y, double lamp_cd_m2 = 0, std::uint32_t seed = 1) {
    ImageF image(width, height, 3);
    std::uint32_t state = seed * 2654435761u + 1;
    const auto random = [&] {
        state ^= state << 13, state ^= state >> 17, state ^= state << 5;
        return static_cast<double>(state >> 8) / 16777216.0;
    };
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            const double shape =
                0.7 * std::sin(i * 0.031 + 1.3 * std::sin(j * 0.017)) + (((i / 4 + j / 4) & 1) ? 0.4 : -0.4) + 0.8 * (random() - 0.5);
            const double light = y * std::pow(10, shape);
            const double tints[3] = {1 + 0.5 * std::sin(i * 0.05), 1 + 0.3 * std::sin(j * 0.07), 1 + 0.6 * std::cos(i * 0.03 + j * 0.02)};
            for (int c = 0; c < 3; ++c) image.at(i, j, c) = static_cast<float>(light * tints[c]);
        }
    if (lamp_cd_m2 > 0)
        for (int j = height / 3; j < height / 3 + 7 && j < height; ++j)
            for (int i = width / 3; i < width / 3 + 7 && i < width; ++i)
                for (int c = 0; c < 3; ++c) image.at(i, j, c) = static_cast<float>(lamp_cd_m2);
    return image;
}

// The left eye of a real Vive (facts/devices.md 1.4), on a panel of any size.
inline EyeGeometry vive_lens(int width = 1440, int height = 1600) {
    EyeGeometry g{};
    g.kind = geometry_lens;
    g.width = static_cast<uint>(width);
    g.height = static_cast<uint>(height);
    g.aspect = 0.9f;
    g.r2_cutoff = vec3(1.13237f);
    g.focal = {1.208483f, 1.087995f};
    g.principal_point = {-0.091697f, -0.003448f};
    const vec2 centre(0.091697f, -0.003831f);
    g.channels[0] = {centre, {-0.185625f, -0.074014f, -0.022441f}};
    g.channels[1] = {centre, {-0.220272f, -0.020256f, -0.051815f}};
    g.channels[2] = {centre, {-0.254333f, 0.030692f, -0.082884f}};
    return g;
}

// What the lens does not show is black, as the stage leaves it.
template <class T> Image<T> through_lens(Image<T> image, const EyeGeometry& g) {
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < image.channels; ++c)
                if (!geometry::geometry_visible(g, {x + 0.5, y + 0.5})) image.at(x, y, c) = 0;
    return image;
}

// Whether the lens's rim passes the pixel's middle within a thousandth of a pixel: there float and double may differ in what is shown.
inline bool is_on_the_rim(const EyeGeometry& g, int x, int y) {
    constexpr double near = 1e-3;
    const auto shown = [&](double dx, double dy) { return geometry::geometry_visible(g, {x + 0.5 + dx, y + 0.5 + dy}); };
    const bool here = shown(0, 0);
    return shown(near, 0) != here || shown(-near, 0) != here || shown(0, near) != here || shown(0, -near) != here;
}

}  // namespace entoptic::perception::testing
