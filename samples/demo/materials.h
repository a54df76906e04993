// The textures of the office, painted at start-up.
#pragma once

#include <vector>

#include "samples/demo/canvas.h"

namespace samples {

enum class Material {
    plain,  // white; the patch's tint is its albedo
    wood,
    floor,
    plaster,
    fabric,
    acuity_chart,
    colour_poster,
    stripes_poster,
    book_spines,
    keyboard,
    paper,
    screen,
    mug,
    calendar,
    outdoors,  // not an albedo: luminance of the view outside over that of the sky
    count
};

// Books on one row of the spines texture; equal widths, numbered from the left.
constexpr int spines_per_texture = 16;

// One canvas a material, in the order of the enumeration. Takes part of a second; uses all cores.
std::vector<Canvas> paint_materials();

}  // namespace samples
