// Painting textures: an image of linear albedos with anti-aliased shapes and text. Coordinates are 0…1 from the top left, over
// the width for x and over the height for y, so that what is painted does not depend on the resolution.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace samples {

// Decodes an sRGB colour written 0xRRGGBB, as colours are given in tables, to linear light.
glm::vec3 srgb(std::uint32_t code);

// A number in [0, 1) that depends on its arguments alone: textures and baking are the same in every run.
float hash01(std::uint32_t a, std::uint32_t b = 0, std::uint32_t c = 0);

// Smooth noise in [0, 1] with period `period` in both directions, so that a texture tiles.
float tiling_noise(glm::vec2 p, std::uint32_t period, std::uint32_t seed);

class Canvas {
public:
    Canvas(std::uint32_t width, std::uint32_t height, glm::vec3 albedo);

    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }
    float aspect() const { return static_cast<float>(width_) / static_cast<float>(height_); }

    // Replaces every pixel by f(position of its centre).
    void shade(const std::function<glm::vec3(glm::vec2)>& f);
    void rectangle(glm::vec2 from, glm::vec2 to, glm::vec3 albedo);
    // Radii are fractions of the height, so that a circle is round on any canvas.
    void disc(glm::vec2 centre, float radius, glm::vec3 albedo);
    // A Landolt C: outer diameter `size` (fraction of the height), stroke and gap a fifth of it; the gap points at
    // `quarter` * 90° counter-clockwise from the right.
    void landolt_c(glm::vec2 centre, float size, int quarter, glm::vec3 ink);
    // A Snellen E on a 5 x 5 grid of side `size`; the prongs point as the gap of the Landolt C does.
    void snellen_e(glm::vec2 centre, float size, int quarter, glm::vec3 ink);
    // Capitals, digits and a few signs in a 5 x 7 dot face; `height` is that of a letter, `at` its top left.
    void text(glm::vec2 at, float height, std::string_view words, glm::vec3 ink);
    float text_width(float height, std::string_view words) const;

    // Mean albedo over all pixels.
    glm::vec3 mean() const;
    // The mip chain in 8-bit sRGB with opaque alpha. Levels are averaged in linear light.
    std::vector<std::vector<std::byte>> srgb_levels() const;

private:
    // Mixes `albedo` in by the part of each pixel for which `inside` (signed distance in pixels, positive inside) holds.
    void blend(glm::vec2 from, glm::vec2 to, glm::vec3 albedo, const std::function<float(glm::vec2)>& inside);

    std::uint32_t width_, height_;
    std::vector<glm::vec3> pixels_;
};

}  // namespace samples
