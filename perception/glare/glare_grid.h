// The grid on which wide glare is computed: one or more patches of the sphere a view, each in azimuthal equidistant projection about its
// axis, so that one kernel in degrees holds all over the view (a flat picture's own pixels differ 2.6 times across 104 degrees); and a
// lattice of nodes, every `step` pixels of the eye image, through which pixels and texels exchange light.
//
// Light goes pixels -> nodes -> texels by quadratic B-splines and comes back by the same weights, so both ways are adjoint: energy and
// centroid are kept, and a uniform field stays uniform to rounding.
#pragma once

#include "perception/glare/glare_gpu.h"
#include "shaders/eye_geometry.h"

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace entoptic::perception {

struct GlarePatch {
    uint view = 0;
    glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
};

struct GlareGrid {
    uint n = 0;                           // texels of a side: 64, 128, 256 or 512
    double pitch = 0;                     // rad a texel
    double smallest_step = 0;             // between pixels, rad
    double pixel_rad = 0;                 // mean pixel step, rad: near_px times this is the radius of the near field
    uint step = 1;                        // pixels between nodes: 1, 2, 4 or 8
    double damping = 12;                  // exponent of sinc that the splines to the grid and back make: see sharpening()
    uint nodes_x = 0, nodes_y = 0;        // of a view; node n stands on pixel step (n - 1)
    uint first_row = 0, rows = 0;         // rows of the grid that hold light
    uint taps = 1;                        // a node: 1 for one patch a view, 26 for those of a sphere
    std::vector<GlarePatch> patches;
    std::vector<NodeTap> node_taps;       // view, node, tap
    std::vector<uint> splat_offsets;      // patch, row, column, and one more at the end
    std::vector<SplatEntry> splat_entries;
};

// Share of the grid's side that light may occupy; the rest is zero padding against wrap-around (facts 3.3c: 25 % of padding leaves 3.4 %).
constexpr double glare_occupied = 0.72;

// `texel_px`: least width of a texel in mean pixels; the field's own size may ask for more. The grid has as few texels as that allows, but not
// fewer than `least_texels` a side.
GlareGrid make_glare_grid(std::span<const EyeGeometry> views, double texel_px, uint least_texels = least_glare_n);

}  // namespace entoptic::perception
