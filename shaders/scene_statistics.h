// Statistics of an eye image, in two steps: per tile by perception/tiles.comp, per view by perception/statistics.comp.
#ifndef ENTOPTIC_SHADERS_SCENE_STATISTICS_H
#define ENTOPTIC_SHADERS_SCENE_STATISTICS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic {
#endif

// A tile, in pixels.
const uint tile_width = 32;
const uint tile_height = 8;

// The fourth component of an eye-image pixel.
const float pixel_hidden = 0.0f;    // the lens does not show it
const float pixel_visible = 1.0f;
const float pixel_cleaned = 2.0f;   // visible, and held NaN, infinity, a negative or too much

// Largest luminance of a scene, cd/m². The solar disc is 1.6e9; facts/perception.md section 1 clamps at 1e8.
const float max_scene_cd_m2 = 1e8f;
// Luminance floor of everything that takes a logarithm or divides, cd/m².
const float min_scene_cd_m2 = 1e-6f;
// Nearest that anything is taken to be, 1/m: 5 cm. Distances are kept as 1 over metres, 0 is infinitely far.
const float max_dioptre = 20.0f;
const float unknown_dioptre = -1.0f;

struct TileStatistics {
    float sum_y_sr;       // sum over visible pixels of luminance times solid angle, cd/m² sr
    float sum_sr;         // sum of solid angles, sr
    float min_y, max_y;   // cd/m²; an empty tile has min 3e38, max 0
    float max_channel;    // largest of R, G, B, cd/m²
    uint cleaned;         // pixels that held NaN, infinity, a negative or more than max_scene_cd_m2
    uint visible;         // pixels that the lens shows
};

// Points of a tile that a glance looks at when the whole scene need not be drawn: columns by rows, in the middles of as many equal parts.
const uint glance_columns = 8;
const uint glance_rows = 2;

const uint histogram_bins = 64;     // of log10 luminance of tile means, from -6 to 8

// Of one view (eye).
struct SceneStatistics {
    float min_y, max_y, max_channel;   // cd/m², over visible pixels
    float mean_y;                      // solid-angle mean, cd/m²
    float median_tile_y;               // of tile means, from the histogram, cd/m²
    float gaze_y;                      // gaze-weighted mean that drives adaptation, cd/m² (written by the adaptation model)
    float sum_sr;                      // solid angle of the view, sr
    float dark_share;                  // share of the solid angle in tiles whose mean is darker than the display's black
    uint cleaned, visible;
    uint histogram[histogram_bins];    // tiles a bin
};

#ifdef __cplusplus
static_assert(sizeof(TileStatistics) == 28 && sizeof(SceneStatistics) == 40 + 4 * 64, "scalar layout: the GLSL side must agree");
}  // namespace entoptic
#endif

#endif
