// What the glare engine's C++ and its shaders say to each other. Scalar layout.
#ifndef ENTOPTIC_PERCEPTION_GLARE_GLARE_GPU_H
#define ENTOPTIC_PERCEPTION_GLARE_GLARE_GPU_H

#include "perception/gate.h"
#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

const uint glare_n = 512;              // texels of a side of the largest grid; GlareGrid::n has those of this one
const uint least_glare_n = 64;
const uint glare_row = 520;            // floats or complex numbers from one row to the next: 8 more, so that columns do not collide in a cache
const uint glare_plane = 512 * 520;

// A kernel over the angle: entries evenly in log(theta) from radial_first to pi, so that linear interpolation of theta^-3 is good to 1e-5.
const uint radial_entries = 4096;
const float radial_first = 1e-4f;      // rad, 0.08 pixels of a Vive; a kernel is flat below
const uint radial_parts = 3;
// Per sr, in R, G, B: the kernel is the sum of the parts, weighted by what the pupil makes of them (GlareStrength::weights).
struct RadialEntry {
    vec3 part[radial_parts];
};

// The light that a convolution scatters, a channel at a time, with W = ToneCurve::scene_white_cd_m2.
const uint source_scene = 0;           // C
const uint source_excess = 1;          // max(C - W, 0): what the panel cannot send
const uint source_displayed = 2;       // min(C, W): what it sends, in scene units
const uint source_drawn = 3;           // what the convolutions before have changed in what it sends

// Entries of Gate.dispatch.
const uint gate_tiles = 0, gate_pixels = 1, gate_splat = 2, gate_rows = 3, gate_columns = 4, gate_gather = 5, gate_near = 6, gate_apply = 7;
const uint gate_entries = 8;           // of GatePush; two more:
const uint gate_billboard_choice = 8, gate_billboards = 9;

// Why the gate ran or not (Gate.reason).
const uint gate_reason_runs = 0, gate_reason_dark = 1, gate_reason_uniform = 2, gate_reason_within_panel = 3;

const uint max_near_px = 24;           // reach of the near field where pixels are small; three tiles high, less than one wide
const uint near_none = 0, near_reached = 1, near_beside = 2;      // of a tile, in the flags
const uint max_near_groups = 4096;     // workgroups of the near field; each takes every 4096th tile of the list

// One node of the coarse pixel lattice, as a tap into one patch of the glare grid.
struct NodeTap {
    uint patch_index;
    float u, v;                        // texels
    float weight;
};

// One contribution of a node to a texel: its spline's weight.
struct SplatEntry {
    uint node;
    float weight;
};

struct GatePush {
    float scattered;                   // upper bound of the share of the picture's own light that leaves its pixel
    uint views;
    uint always;                       // 1: the kernel has a colour cast, which a uniform field shows too
    uint excess;                       // 1: light above the panel's white is scattered
    GateDispatch groups[gate_entries];
};

struct TilesPush {
    uint tiles_x, tiles_y, views;
    float near_from;                   // times the adaptation luminance; < 0: the panel's white
    uint rows;                         // of tiles that the near field reaches up and down
};

struct LatticePush {                   // pixels -> nodes, apply
    uint width, height, nodes_x, nodes_y, step;
    uint tiles_x, tiles_y;
    uint near;                         // 1: tiles with a near field are flagged
    uint turn;                         // nodes' channel c takes the light's channel c + turn
};

struct SplatPush {
    uint first_column, first_row, columns, rows;
    uint patches;
    uint channels;                     // of the node values: 3 for light, 1 for coverage
};

struct ZonePush {
    uint nodes_x, nodes_y, step;
    uint first;                        // of the values that are weighed
    uint zone, zones;
};

// Lit texels of the grid, while they are few: what a billboard is drawn at.
const uint max_billboards = 256;
struct LitTexel {
    uint place;                        // grid (pair of patches), row, column
    vec3 of[2];                        // light of both patches
};

struct BillboardPush {
    uint first_row, rows;              // of the grid that hold light
    uint pairs;
    uint most;                         // lit texels for which billboards are drawn
    uint first_key, second_key;
    float blend;
    GateDispatch groups[3];            // rows, columns, billboards
};

struct FftPush {
    uint first_row;                    // rows pass: first row to do
    uint rows;                         // rows that hold data; columns pass: others are zero
    uint input_channels;               // 1: all channels read the same grid (coverage)
    uint first_key, second_key;        // planes of the kernel's spectrum
    float blend;                       // 0: first key .. 1: second
    float damping;                     // kernel: of the splines that smooth it, and
    uint order;                        // how far it is sharpened: see sharpening() of the math
};

struct GatherPush {
    uint nodes_x, nodes_y, step, taps;
    uint key;                          // coverage: where to write
    uint first_key, second_key;
    float blend;
    float sign;                        // of what arrives and leaves
    uint leaves;                       // 1: what is scattered leaves its place
    uint add;                          // 1: adds to what convolutions before have left
    uint positive;                     // 1: the kernel is light everywhere; what its samples make negative is cut off
    float window_sigma;                // rad
    vec3 gain;
    vec3 gaze[2];                      // of the views
};

struct NearPush {
    uint width, height, tiles_x, tiles_y;
    uint profile;                      // first entry of the near part of the kernel's profile
    uint turn;                         // channel c takes the light's channel c + turn
    uint leaves, add;                  // as in GatherPush
    float near;                        // rad
    float near_from;                   // as in TilesPush
    float window_sigma;                // rad
    vec3 weights;                      // of the profile's parts
    vec3 gaze[2];
};

struct KernelPush {
    float pitch;                       // rad
    uint profile;                      // first entry of its far part
    vec3 weights;                      // of the profile's parts
};

#ifdef __cplusplus
static_assert(sizeof(GatePush) <= 128 && sizeof(GatherPush) <= 128 && sizeof(NearPush) <= 128 && sizeof(BillboardPush) <= 128, "push constants");
}  // namespace entoptic::perception
#endif

#endif
