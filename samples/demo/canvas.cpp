#include "samples/demo/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace samples {

namespace {

constexpr int glyph_columns = 5;
constexpr int glyph_rows = 7;
constexpr float glyph_advance = 6.0F;  // dots from one letter to the next

// Seven rows from the top, five bits each, the leftmost dot in bit 4.
struct Glyph {
    char sign;
    std::array<std::uint8_t, glyph_rows> rows;
};

constexpr std::array<Glyph, 41> glyphs{{
    {'A', {0x0E, 0x11, 0x11, 0x1F, 0x11, 0x11, 0x11}}, {'B', {0x1E, 0x11, 0x11, 0x1E, 0x11, 0x11, 0x1E}},
    {'C', {0x0E, 0x11, 0x10, 0x10, 0x10, 0x11, 0x0E}}, {'D', {0x1E, 0x11, 0x11, 0x11, 0x11, 0x11, 0x1E}},
    {'E', {0x1F, 0x10, 0x10, 0x1E, 0x10, 0x10, 0x1F}}, {'F', {0x1F, 0x10, 0x10, 0x1E, 0x10, 0x10, 0x10}},
    {'G', {0x0E, 0x11, 0x10, 0x17, 0x11, 0x11, 0x0E}}, {'H', {0x11, 0x11, 0x11, 0x1F, 0x11, 0x11, 0x11}},
    {'I', {0x0E, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0E}}, {'J', {0x07, 0x02, 0x02, 0x02, 0x02, 0x12, 0x0C}},
    {'K', {0x11, 0x12, 0x14, 0x18, 0x14, 0x12, 0x11}}, {'L', {0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x1F}},
    {'M', {0x11, 0x1B, 0x15, 0x15, 0x11, 0x11, 0x11}}, {'N', {0x11, 0x19, 0x15, 0x13, 0x11, 0x11, 0x11}},
    {'O', {0x0E, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0E}}, {'P', {0x1E, 0x11, 0x11, 0x1E, 0x10, 0x10, 0x10}},
    {'Q', {0x0E, 0x11, 0x11, 0x11, 0x15, 0x12, 0x0D}}, {'R', {0x1E, 0x11, 0x11, 0x1E, 0x14, 0x12, 0x11}},
    {'S', {0x0F, 0x10, 0x10, 0x0E, 0x01, 0x01, 0x1E}}, {'T', {0x1F, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04}},
    {'U', {0x11, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0E}}, {'V', {0x11, 0x11, 0x11, 0x11, 0x11, 0x0A, 0x04}},
    {'W', {0x11, 0x11, 0x11, 0x15, 0x15, 0x1B, 0x11}}, {'X', {0x11, 0x11, 0x0A, 0x04, 0x0A, 0x11, 0x11}},
    {'Y', {0x11, 0x11, 0x0A, 0x04, 0x04, 0x04, 0x04}}, {'Z', {0x1F, 0x01, 0x02, 0x04, 0x08, 0x10, 0x1F}},
    {'0', {0x0E, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0E}}, {'1', {0x04, 0x0C, 0x04, 0x04, 0x04, 0x04, 0x0E}},
    {'2', {0x0E, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1F}}, {'3', {0x1F, 0x02, 0x04, 0x02, 0x01, 0x11, 0x0E}},
    {'4', {0x02, 0x06, 0x0A, 0x12, 0x1F, 0x02, 0x02}}, {'5', {0x1F, 0x10, 0x1E, 0x01, 0x01, 0x11, 0x0E}},
    {'6', {0x06, 0x08, 0x10, 0x1E, 0x11, 0x11, 0x0E}}, {'7', {0x1F, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08}},
    {'8', {0x0E, 0x11, 0x11, 0x0E, 0x11, 0x11, 0x0E}}, {'9', {0x0E, 0x11, 0x11, 0x0F, 0x01, 0x02, 0x0C}},
    {'.', {0x00, 0x00, 0x00, 0x00, 0x00, 0x0C, 0x0C}}, {',', {0x00, 0x00, 0x00, 0x00, 0x0C, 0x04, 0x08}},
    {'-', {0x00, 0x00, 0x00, 0x0E, 0x00, 0x00, 0x00}}, {'/', {0x01, 0x01, 0x02, 0x04, 0x08, 0x10, 0x10}},
    {':', {0x00, 0x0C, 0x0C, 0x00, 0x0C, 0x0C, 0x00}},
}};

float linear_from_srgb(float value) { return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F); }

// The sRGB code of a linear value by table: eight million pixels are encoded at start-up.
std::uint8_t srgb_code(float linear) {
    static const auto table = [] {
        std::array<std::uint8_t, 4096> codes{};
        for (std::size_t i = 0; i < codes.size(); ++i) {
            const float root = static_cast<float>(i) / 4095.0F;  // of the value: spreads the dark ones
            const float value = root * root;
            const float encoded = value <= 0.0031308F ? 12.92F * value : 1.055F * std::pow(value, 1.0F / 2.4F) - 0.055F;
            codes[i] = static_cast<std::uint8_t>(encoded * 255.0F + 0.5F);
        }
        return codes;
    }();
    return table[static_cast<std::size_t>(std::sqrt(std::clamp(linear, 0.0F, 1.0F)) * 4095.0F + 0.5F)];
}

// A vector turned by a quarter * 90° clockwise in y-down coordinates: brings the direction of a gap to +x.
glm::vec2 turned(glm::vec2 p, int quarter) {
    for (int i = 0; i < (quarter & 3); ++i) { p = {-p.y, p.x}; }
    return p;
}

}  // namespace

glm::vec3 srgb(std::uint32_t code) {
    const auto channel = [code](int shift) { return linear_from_srgb(static_cast<float>((code >> shift) & 0xFFU) / 255.0F); };
    return {channel(16), channel(8), channel(0)};
}

// Rounds of multiply and xor-shift; only that the bits look unrelated matters here.
float hash01(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    std::uint32_t h = a * 0x9E3779B1U ^ (b + 0x7F4A7C15U) * 0x85EBCA77U ^ (c + 0x165667B1U) * 0xC2B2AE3DU;
    for (int i = 0; i < 2; ++i) {
        h ^= h >> 15;
        h *= 0x2C1B3C6DU;
        h ^= h >> 13;
        h *= 0x297A2D39U;
    }
    return static_cast<float>((h ^ (h >> 16)) >> 8) * 0x1p-24F;
}

float tiling_noise(glm::vec2 p, std::uint32_t period, std::uint32_t seed) {
    const glm::vec2 cell = glm::floor(p);
    const glm::vec2 t = p - cell;
    const glm::vec2 s = t * t * (3.0F - 2.0F * t);
    const auto corner = [&](int dx, int dy) {
        const auto n = static_cast<int>(period);
        const int x = ((static_cast<int>(cell.x) + dx) % n + n) % n;
        const int y = ((static_cast<int>(cell.y) + dy) % n + n) % n;
        return hash01(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), seed);
    };
    return glm::mix(glm::mix(corner(0, 0), corner(1, 0), s.x), glm::mix(corner(0, 1), corner(1, 1), s.x), s.y);
}

Canvas::Canvas(std::uint32_t width, std::uint32_t height, glm::vec3 albedo)
    : width_(width), height_(height), pixels_(std::size_t{width} * height, albedo) {}

void Canvas::shade(const std::function<glm::vec3(glm::vec2)>& f) {
    const glm::vec2 size(width_, height_);
    for (std::uint32_t y = 0; y < height_; ++y) {
        for (std::uint32_t x = 0; x < width_; ++x) { pixels_[std::size_t{y} * width_ + x] = f((glm::vec2(x, y) + 0.5F) / size); }
    }
}

void Canvas::blend(glm::vec2 from, glm::vec2 to, glm::vec3 albedo, const std::function<float(glm::vec2)>& inside) {
    const auto first_x = static_cast<std::uint32_t>(std::max(from.x - 1.0F, 0.0F));
    const auto first_y = static_cast<std::uint32_t>(std::max(from.y - 1.0F, 0.0F));
    const auto last_x = static_cast<std::uint32_t>(std::clamp(to.x + 2.0F, 0.0F, static_cast<float>(width_)));
    const auto last_y = static_cast<std::uint32_t>(std::clamp(to.y + 2.0F, 0.0F, static_cast<float>(height_)));
    for (std::uint32_t y = first_y; y < last_y; ++y) {
        for (std::uint32_t x = first_x; x < last_x; ++x) {
            const float coverage = std::clamp(inside(glm::vec2(x, y) + 0.5F) + 0.5F, 0.0F, 1.0F);
            glm::vec3& pixel = pixels_[std::size_t{y} * width_ + x];
            pixel = glm::mix(pixel, albedo, coverage);
        }
    }
}

static float inside_rectangle(glm::vec2 p, glm::vec2 from, glm::vec2 to) {
    const glm::vec2 inner = glm::min(p - from, to - p);
    return std::min(inner.x, inner.y);
}

void Canvas::rectangle(glm::vec2 from, glm::vec2 to, glm::vec3 albedo) {
    const glm::vec2 size(width_, height_);
    from *= size;
    to *= size;
    blend(from, to, albedo, [=](glm::vec2 p) { return inside_rectangle(p, from, to); });
}

void Canvas::disc(glm::vec2 centre, float radius, glm::vec3 albedo) {
    centre *= glm::vec2(width_, height_);
    radius *= static_cast<float>(height_);
    blend(centre - radius, centre + radius, albedo, [=](glm::vec2 p) { return radius - glm::length(p - centre); });
}

void Canvas::landolt_c(glm::vec2 centre, float size, int quarter, glm::vec3 ink) {
    centre *= glm::vec2(width_, height_);
    const float outer = 0.5F * size * static_cast<float>(height_);
    const float stroke = outer * 0.4F;
    blend(centre - outer, centre + outer, ink, [=](glm::vec2 p) {
        const glm::vec2 q = turned(p - centre, quarter);
        const float r = glm::length(q);
        const float ring = std::min(outer - r, r - (outer - stroke));
        const float gap = std::min(0.5F * stroke - std::abs(q.y), q.x);
        return std::min(ring, -gap);
    });
}

void Canvas::snellen_e(glm::vec2 centre, float size, int quarter, glm::vec3 ink) {
    centre *= glm::vec2(width_, height_);
    const float half = 0.5F * size * static_cast<float>(height_);
    const float unit = half * 0.4F;
    blend(centre - half, centre + half, ink, [=](glm::vec2 p) {
        const glm::vec2 q = turned(p - centre, quarter);
        const float spine = inside_rectangle(q, {-half, -half}, {-half + unit, half});
        float prongs = -half;
        for (const float y : {-half, -0.5F * unit, half - unit}) {
            prongs = std::max(prongs, inside_rectangle(q, {-half, y}, {half, y + unit}));
        }
        return std::max(spine, prongs);
    });
}

float Canvas::text_width(float height, std::string_view words) const {
    return height / glyph_rows * glyph_advance * static_cast<float>(words.size()) / aspect();
}

void Canvas::text(glm::vec2 at, float height, std::string_view words, glm::vec3 ink) {
    const glm::vec2 dot = glm::vec2(1.0F / aspect(), 1.0F) * (height / glyph_rows);
    for (const char sign : words) {
        const auto* const glyph = std::find_if(glyphs.begin(), glyphs.end(), [sign](const Glyph& g) { return g.sign == sign; });
        for (int row = 0; glyph != glyphs.end() && row < glyph_rows; ++row) {
            for (int column = 0; column < glyph_columns; ++column) {
                if ((glyph->rows[static_cast<std::size_t>(row)] >> (glyph_columns - 1 - column) & 1) != 0) {
                    const glm::vec2 corner = at + glm::vec2(column, row) * dot;
                    rectangle(corner, corner + dot, ink);
                }
            }
        }
        at.x += dot.x * glyph_advance;
    }
}

glm::vec3 Canvas::mean() const {
    glm::dvec3 sum(0);
    for (const glm::vec3& pixel : pixels_) { sum += pixel; }
    return sum / static_cast<double>(pixels_.size());
}

static std::vector<std::byte> encode(const std::vector<glm::vec3>& pixels) {
    std::vector<std::byte> bytes;
    bytes.reserve(pixels.size() * 4);
    for (const glm::vec3& p : pixels) {
        for (int i = 0; i < 3; ++i) { bytes.push_back(std::byte{srgb_code(p[i])}); }
        bytes.push_back(std::byte{255});
    }
    return bytes;
}

std::vector<std::vector<std::byte>> Canvas::srgb_levels() const {
    std::vector<std::vector<std::byte>> levels{encode(pixels_)};
    std::vector<glm::vec3> finer = pixels_;
    std::uint32_t width = width_, height = height_;
    while (width > 1 || height > 1) {
        const std::uint32_t w = std::max(width / 2, 1U), h = std::max(height / 2, 1U);
        std::vector<glm::vec3> coarser(std::size_t{w} * h);
        for (std::uint32_t y = 0; y < h; ++y) {
            for (std::uint32_t x = 0; x < w; ++x) {
                const auto at = [&](std::uint32_t i, std::uint32_t j) {  // the last row or column stands in for one beyond
                    return finer[std::size_t{std::min(j, height - 1)} * width + std::min(i, width - 1)];
                };
                coarser[std::size_t{y} * w + x] =
                    0.25F * (at(2 * x, 2 * y) + at(2 * x + 1, 2 * y) + at(2 * x, 2 * y + 1) + at(2 * x + 1, 2 * y + 1));
            }
        }
        finer = std::move(coarser);
        width = w;
        height = h;
        levels.push_back(encode(finer));
    }
    return levels;
}

}  // namespace samples
