// For the tests and benches of the slot `dof`: pictures with known distances, and the shaders' gathering in double. Header-only.
#pragma once

#include "perception/dof/dof_gpu.h"
#include "perception/dof/dof_math.glsl"
#include "perception/testing/scenes.h"
#include "shaders/geometry.glsl"

#include <limits>
#include <numbers>
#include <vector>

namespace entoptic::perception::testing {

inline constexpr float infinitely_far = std::numeric_limits<float>::infinity();

inline ImageF distance(int width, int height, float metres) { return ImageF(width, height, 1, metres); }

// The left part of a picture, up to `edge`, is `near_m` away, the right part `far_m`.
inline ImageF two_distances(int width, int height, int edge, float near_m, float far_m) {
    ImageF depth(width, height, 1, far_m);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < edge; ++x) depth.at(x, y, 0) = near_m;
    return depth;
}

// A floor that runs from `near_m` at the bottom to `far_m` at the top, evenly in dioptres, with a post of `post_m` in the middle, and a
// corner of which nothing is known.
inline ImageF floor_with_post(int width, int height, float near_m, float far_m, float post_m) {
    ImageF depth(width, height, 1);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float t = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
            const bool post = x >= width * 2 / 5 && x < width / 2, unknown = x > width * 7 / 8 && y < height / 8;
            depth.at(x, y, 0) = unknown ? 0 : post ? post_m : 1 / (t / near_m + (1 - t) / far_m);
        }
    return depth;
}

inline ImageD dioptres(const ImageF& depth) {
    ImageD out(depth.width, depth.height, 1);
    for (std::size_t i = 0; i < depth.data.size(); ++i) {
        const double metres = static_cast<double>(depth.data[i]);
        out.data[i] = metres > 0 ? std::min(1 / metres, 20.0) : -1;
    }
    return out;
}

// dof_pixels.glsl and dof_gather.comp, without sampling. `radii(dioptre, pixel_rad)` as the model's blur_radii_px().
template <class Radii>
ImageD gathered_twin(const ImageF& picture, const ImageF& depth, const EyeGeometry& g, double focus, uint colours, Radii radii) {
    struct Pixel {
        double dioptre, side;
        glm::dvec3 radius;
    };
    const int width = picture.width, height = picture.height;
    const ImageD known = dioptres(depth);
    std::vector<Pixel> pixels;
    double widest = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const glm::dvec2 px(x + 0.5, y + 0.5);
            Pixel pixel{focus, 0, glm::dvec3(0)};
            const double d = known.at(x, y, 0);
            if (d >= 0) pixel = {d, glm::sign(d - focus), radii(d, std::sqrt(geometry::geometry_solid_angle(g, px)))};
            if (!geometry::geometry_visible(g, px)) pixel = {-1, 0, glm::dvec3(0)};
            widest = std::max({widest, pixel.radius.x, pixel.radius.y, pixel.radius.z});
            pixels.push_back(pixel);
        }
    const int reach = static_cast<int>(widest + 0.5);
    ImageD out = convert<double>(picture);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Pixel& own = pixels[static_cast<std::size_t>(y * width + x)];
            if (own.dioptre < 0) continue;
            dof::Gathered sums = dof::nothing_gathered();
            for (int j = std::max(0, y - reach); j <= std::min(height - 1, y + reach); ++j)
                for (int i = std::max(0, x - reach); i <= std::min(width - 1, x + reach); ++i) {
                    const Pixel& other = pixels[static_cast<std::size_t>(j * width + i)];
                    const bool in_front = other.dioptre > own.dioptre;
                    const glm::dvec3 r = in_front ? other.radius : glm::min(other.radius, own.radius);
                    const double far = std::hypot(i - x, j - y);
                    glm::dvec3 share(dof::disc_share(r.x, far));
                    if (colours == dof_colours_lca) share = {share.x, dof::disc_share(r.y, far), dof::disc_share(r.z, far)};
                    if (colours == dof_colours_rows) share *= dof::row_filter(other.side, r.x, j - y);
                    const glm::dvec3 light = share * glm::dvec3(picture.at(i, j, 0), picture.at(i, j, 1), picture.at(i, j, 2));
                    (in_front ? sums.front : sums.behind) += light;
                    (in_front ? sums.front_share : sums.behind_share) += share;
                }
            const glm::dvec3 light = dof::gathered_light(sums);
            for (int c = 0; c < 3; ++c) out.at(x, y, c) = light[c];
        }
    return through_lens(out, g);
}

}  // namespace entoptic::perception::testing
