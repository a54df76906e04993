// The grid of nodes on which local means of luminance are kept. Scalar layout, one struct for C++ and GLSL.
#ifndef ENTOPTIC_PERCEPTION_LOCAL_MEAN_GRID_H
#define ENTOPTIC_PERCEPTION_LOCAL_MEAN_GRID_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct LocalMeanGrid {
    uint width, height;      // of the picture, pixels
    uint cell;               // pixels across a cell; a node is the middle of its cell
    uint nodes_x, nodes_y;
    float ppd;               // pixels per degree where no pixel of a cell is visible
};

struct LocalCell {
    float y_sr, sr;          // sums over the cell's visible pixels: luminance times solid angle (cd/m² sr), solid angle (sr)
    float ppd;               // local pixels per degree
};

#ifdef __cplusplus
static_assert(sizeof(LocalMeanGrid) == 24 && sizeof(LocalCell) == 12, "scalar layout: the GLSL side must agree");
}  // namespace entoptic::perception
#endif

#endif
