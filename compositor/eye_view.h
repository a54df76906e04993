// Geometry of an eye: from a headset's optics to the eye image's grid, the panel's grid, and the tiles that the lens shows.
#pragma once

#include "interfaces/headset.h"
#include "shaders/eye_geometry.h"

#include <cstdint>
#include <vector>

namespace entoptic::compositor {

// The panel of one eye as the lens shows it: pixel (i, j) is panel pixel (i, j), direction by the green lens, cut off where the lens ends.
EyeGeometry panel_geometry(const EyeOptics& optics, std::uint32_t width, std::uint32_t height);

// The eye image: the same grid (scaled, where width and height are not the panel's), cut off a little later than the panel: light of the
// panel's rim is seen in blue where green would be shown beyond the rim, and the lens pass takes it from there. At the edges of the panel
// itself there is nothing beyond; the last pixel is repeated.
EyeGeometry eye_geometry(const EyeOptics& optics, std::uint32_t width, std::uint32_t height);

// True when the lens treats all colours alike.
bool is_achromatic(const EyeGeometry& geometry);

// Tiles of tile_w × tile_h pixels, as x | y << 16, row by row: those with a visible pixel, and the others.
struct TileLists {
    std::vector<std::uint32_t> shown, hidden;
};
TileLists tile_lists(const EyeGeometry& geometry, std::uint32_t tile_w, std::uint32_t tile_h);

}  // namespace entoptic::compositor
