// Level of detail by what an eye can see: simpler grids of a patch, and which of them an eye cannot tell from the whole one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "samples/common/xr_app.h"
#include "samples/demo/office.h"

namespace samples {

enum class Detail { full, gaze };

// A patch of which only every column_step-th column and every row_step-th row of vertices is used.
struct DetailLevel {
    int column_step = 1, row_step = 1;
    // Largest distance, m, between a point of the whole patch and the point of the same (s, t) of this one. Texture and lightmap belong to
    // (s, t), so that this bounds all that moves: silhouette, texture and light.
    float deviation_m = 0;
};

// All levels, the whole patch first: each has half of the triangles of the one before, and is the nearer to the patch of the two that do.
std::vector<DetailLevel> detail_levels(const Patch& patch);

// The triangles of a level, as indices of the whole patch's vertices.
std::vector<std::uint32_t> triangles_of(const Patch& patch, const DetailLevel& level);

// The patch with the vertices of a level alone.
Patch reduced(const Patch& patch, const DetailLevel& level);

// Spheres of one radius, m, that hold all of a patch.
struct Cover {
    std::vector<glm::vec3> centres;
    float radius = 0;
};
Cover cover_of(const Patch& patch);

// How far, m, points of what `cover` holds may move without an eye's seeing it: a share of the angle that it resolves there
// (XR_ENTOPTICX_observer) times the distance. 0, so that nothing is simplified, within 5 degrees of the gaze as in Liu et al. 2021, equation 14,
// and where the gaze is not known.
float unseen_deviation(const EyeView& view, const Cover& cover);

// The coarsest level that deviates by no more than `unseen_m`. A level coarser than `current` is taken only when it has a margin, so that an
// object at the edge of two levels stays with one.
std::size_t choose_level(const std::vector<DetailLevel>& levels, float unseen_m, std::size_t current);

}  // namespace samples
