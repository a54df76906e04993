#include "drivers/pupil_labs/dark_regions.h"

#include "drivers/pupil_labs/picture_pyramid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace entoptic::drivers {

namespace {

constexpr float least_response = 2;  // grey levels: below, nothing stands out

using Sums = Image<std::int32_t>;

int box(const Sums& sums, int left, int top, int right, int bottom) {
    const std::int32_t *above = &sums.at(0, top, 0), *below = &sums.at(0, bottom, 0);
    return below[right] - below[left] - above[right] + above[left];
}

int value(const Image8& image, int x, int y) { return image.data[static_cast<std::size_t>(y * image.width + x)]; }

// The mean of the square at (x, y) against the squares of the same size left, right, above and below it, those outside the picture
// left out: a lid or a lash darkens one side, not all.
float response_at(const Sums& sums, int width, int height, int x, int y, int half) {
    const int size = 2 * half + 1, gap = half / 2, shift = size + gap;
    const float area = static_cast<float>(size * size);
    const float inside = static_cast<float>(box(sums, x - half, y - half, x + half + 1, y + half + 1)) / area;
    std::array<float, 4> sides;
    std::size_t count = 0;
    const auto side = [&](int cx, int cy) {
        const int left = std::max(cx - half, 0), top = std::max(cy - half, 0), right = std::min(cx + half + 1, width),
                  bottom = std::min(cy + half + 1, height);
        if (right - left < 1 || bottom - top < 1 || 2 * (right - left) * (bottom - top) < size * size) return;
        sides[count++] = static_cast<float>(box(sums, left, top, right, bottom)) / static_cast<float>((right - left) * (bottom - top));
    };
    side(x - shift, y);
    side(x + shift, y);
    side(x, y - shift);
    side(x, y + shift);
    if (count < 3) return 0;
    for (std::size_t i = count; i < sides.size(); ++i) sides[i] = std::numeric_limits<float>::max();
    std::sort(sides.begin(), sides.end());
    const float middle = 0.5f * (sides[1] + sides[count - 2]);
    return std::min(0.7f * sides[1] + 0.3f * middle, sides[0] + 20.0f) - inside;
}

}  // namespace

const std::vector<DarkPlace>& DarkPlaceFinder::find(const Image8& image, int largest_half_size, std::size_t most) {
    integrate(image, sums_);
    all_.clear();
    best_.clear();
    for (int half = 0; half <= largest_half_size; half = half < 3 ? half + 1 : half * 3 / 2) {
        const int step = (half + 2) / 2;
        for (int y = half; y < image.height - half; y += step) {
            for (int x = half; x < image.width - half; x += step) {
                const float response = response_at(sums_, image.width, image.height, x, y, half);
                if (response > least_response) all_.push_back({x, y, half, response});
            }
        }
    }
    std::sort(all_.begin(), all_.end(), [](const DarkPlace& a, const DarkPlace& b) { return a.response > b.response; });
    for (const DarkPlace& place : all_) {
        const bool known = std::any_of(best_.begin(), best_.end(), [&](const DarkPlace& other) {
            const bool alike = 2 * place.half_size + 2 > other.half_size && 2 * other.half_size + 2 > place.half_size;
            return alike &&
                   std::max(std::abs(place.x - other.x), std::abs(place.y - other.y)) <= std::min(other.half_size, place.half_size) + 1;
        });
        if (!known) best_.push_back(place);
        if (best_.size() == most) break;
    }
    return best_;
}

Pixel darkest_near(const Image8& image, int x, int y, int reach) {
    Pixel darkest{std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1)};
    for (int v = std::max(0, y - reach); v <= std::min(image.height - 1, y + reach); ++v) {
        for (int u = std::max(0, x - reach); u <= std::min(image.width - 1, x + reach); ++u)
            if (value(image, u, v) < value(image, darkest.x, darkest.y)) darkest = {u, v};
    }
    return darkest;
}

DarkRegion RegionGrower::grow(const Image8& image, Pixel from, int threshold, int largest_area) {
    const int width = image.width, height = image.height;
    visited_.resize(static_cast<std::size_t>(width * height), 0);
    ++call_;
    const int seed = from.y * width + from.x;
    DarkRegion region;
    if (value(image, from.x, from.y) > threshold) return region;
    double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
    stack_.assign(1, seed);
    visited_[static_cast<std::size_t>(seed)] = call_;
    while (!stack_.empty() && region.area <= largest_area) {
        const int at = stack_.back(), v = at / width, u = at % width;
        stack_.pop_back();
        ++region.area;
        sx += u;
        sy += v;
        sxx += u * u;
        syy += v * v;
        sxy += u * v;
        if (u == 0 || v == 0 || u == width - 1 || v == height - 1) region.at_border = true;
        const auto visit = [&](int cu, int cv) {
            if (cu < 0 || cv < 0 || cu >= width || cv >= height) return;
            const int index = cv * width + cu;
            if (visited_[static_cast<std::size_t>(index)] == call_ || value(image, cu, cv) > threshold) return;
            visited_[static_cast<std::size_t>(index)] = call_;
            stack_.push_back(index);
        };
        visit(u - 1, v);
        visit(u + 1, v);
        visit(u, v - 1);
        visit(u, v + 1);
    }
    const double n = region.area, mx = sx / n, my = sy / n;
    // 1/12: the second moment of a pixel's own square.
    const double cxx = sxx / n - mx * mx + 1.0 / 12, cyy = syy / n - my * my + 1.0 / 12, cxy = sxy / n - mx * my;
    const double mean = 0.5 * (cxx + cyy), spread = std::hypot(0.5 * (cxx - cyy), cxy);
    region.ellipse = ellipse_of(mx + 0.5, my + 0.5, 2 * std::sqrt(mean + spread), 2 * std::sqrt(std::max(mean - spread, 0.0)),
                                0.5 * std::atan2(2 * cxy, cxx - cyy));
    return region;
}

}  // namespace entoptic::drivers
