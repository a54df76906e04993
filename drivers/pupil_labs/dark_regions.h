// Where in a picture of an eye a pupil might be: small places darker than what surrounds them, and the dark regions there. Rough and
// quick; pupil_outline.h decides.
#pragma once

#include "base/image.h"
#include "drivers/pupil_labs/ellipse.h"

#include <cstdint>
#include <vector>

namespace entoptic::drivers {

struct Pixel {
    int x = 0, y = 0;
};

struct DarkPlace {
    int x = 0, y = 0;    // pixel of the picture that was searched
    int half_size = 0;   // of the square that fits best, px
    float response = 0;  // grey levels: how much darker than its four neighbours, the second least of them weighing most
};

// Finds at most `most` places that stand out, best first, no two closer than their size.
class DarkPlaceFinder {
public:
    // `image`: grey, coarse (some 48 px a side); half sizes 0 to `largest_half_size` px are tried.
    const std::vector<DarkPlace>& find(const Image8& image, int largest_half_size, std::size_t most);

private:
    Image<std::int32_t> sums_;
    std::vector<DarkPlace> all_, best_;
};

// The darkest pixel within `reach` pixels of (x, y), each way.
Pixel darkest_near(const Image8& image, int x, int y, int reach);

// The connected region around a seed that is not brighter than a threshold.
struct DarkRegion {
    Ellipse ellipse;         // of the same second moments, px
    int area = 0;            // px
    bool at_border = false;  // touches the picture's edge
};

class RegionGrower {
public:
    // A region larger than `largest_area` is given up: area is then larger than that. Area 0: `seed` itself is brighter.
    DarkRegion grow(const Image8& image, Pixel seed, int threshold, int largest_area);

private:
    std::vector<std::uint32_t> visited_;  // the number of the call that was here last
    std::uint32_t call_ = 0;
    std::vector<int> stack_;
};

}  // namespace entoptic::drivers
