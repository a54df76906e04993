// What the blurs of lightness by pixel share: the plane of lightness, lists of the tiles that hold dark pixels, local pixels per degree.
#pragma once

#include "perception/acuity/acuity.h"

namespace entoptic::perception {

struct LightnessPlanes {
    // Lists of tiles and their dispatches, in this order (luidolt_eq12_tiles.glsl).
    enum class List : std::size_t { lightness, interior, rim };
    static constexpr std::size_t dispatch(List list) { return offsetof(Gate, dispatch) + static_cast<std::size_t>(list) * sizeof(GateDispatch); }

    // `radius`: pixels that the widest kernel reaches, at most luidolt_eq12::max_radius_px.
    static Result<LightnessPlanes> create(const ModelContext& context, int radius);
    // Lists the tiles with a pixel below dark_cd_m2, sets the gate, and fills the first plane around them. `split`: dark tiles that are
    // visible all around go to a list of their own. Leaves a barrier behind.
    void record(StageIo& io, float dark_cd_m2, bool split);

    gpu::Buffer lightness[2];   // with a border; -1 where nothing is visible
    gpu::Buffer density;        // pixels per degree at the corners of tiles
    gpu::Buffer inside;         // a flag a tile
    gpu::Buffer lists;          // of tiles, and their lengths
    gpu::Kernel plan, fill;
    bool clear = false;
    int radius = 0;
};

// Largest number of pixels per degree where something is visible, looked up at corners of tiles.
double largest_ppd(const std::vector<EyeGeometry>& views);

}  // namespace entoptic::perception
