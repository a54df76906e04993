// What luidolt_spectral's C++ and its shaders say to each other. Scalar layout.
#ifndef ENTOPTIC_PERCEPTION_GLARE_LUIDOLT_SPECTRAL_GPU_H
#define ENTOPTIC_PERCEPTION_GLARE_LUIDOLT_SPECTRAL_GPU_H

#include "perception/gate.h"
#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

const uint glare_n = 512;              // texels of a side of the grid
const uint glare_row = 520;            // floats or complex numbers from one row to the next: 8 more, so that columns do not collide in a cache
const uint glare_plane = 512 * 520;
const uint fft_threads = 64;           // one line of 512 by 64 threads of 8 values
const uint fft_lines = 4;              // lines a workgroup

const uint max_wavelengths = 33;       // 32, and one more end point as printed
const uint halo_table_size = 4096;     // halo over sin(theta) 0..1

const uint structure_n = 256;          // binned structure factor, two FFT bins a sample, zero frequency at (128, 128)
const uint cell_samples = 32;          // particle lists: 16 x 16 cells a patch
const uint cells_per_side = 16;
const float pupil_edge_mm = 0.11f;      // a patch counts in full when its centre is this far inside the pupil

// Entries of Gate.dispatch.
const uint gate_tiles = 0, gate_pixels = 1, gate_splat = 2, gate_rows = 3, gate_columns = 4, gate_gather = 5, gate_near = 6, gate_apply = 7;
const uint gate_entries = 8;

// Why the gate ran or not (Gate.reason).
const uint gate_reason_runs = 0, gate_reason_dark = 1, gate_reason_uniform = 2;

const uint max_near_px = 12;           // reach of the near field where pixels are small; two tiles high, less than one wide
const uint max_near_groups = 4096;     // workgroups of the near field; each takes every 4096th tile of the list

// The spectrum, as the kernel sees it.
struct SpectralTable {
    float lambda_um[max_wavelengths];
    vec3 weight[max_wavelengths];      // of a wavelength in R, G, B; sum to `gain`
    uint count;
    vec3 mean_lambda_um;               // sum of weight * lambda
    vec3 gain;                         // energy of the whole kernel: 1, or the colour cast of eq. 9 as printed
};

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
    float scattered;                   // upper bound of the share of light that leaves its pixel
    uint views;
    uint always;                       // 1: the kernel has a colour cast, which a uniform field shows too
    GateDispatch groups[gate_entries];
};

struct TilesPush {
    uint tiles_x, tiles_y, views;
    float near_from;
};

struct LatticePush {                   // pixels -> nodes, apply
    uint width, height, nodes_x, nodes_y, step;
    uint tiles_x, tiles_y;
    uint near;                         // 1: tiles with a near field are flagged
};

struct SplatPush {
    uint first_column, first_row, columns, rows;
    uint patches;
    uint channels;                     // of the node values: 3 for light, 1 for coverage
};

struct FftPush {
    uint first_row;                    // rows pass: first row to do
    uint rows;                         // rows that hold data; columns pass: others are zero
    uint input_channels;               // 1: all channels read the same grid (coverage)
    uint first_key, second_key;        // planes of the kernel's spectrum
    float blend;                       // 0: first key .. 1: second
    float damping;                     // kernel: of the splines that smooth it; see sharpening() of the math
};

struct GatherPush {
    uint nodes_x, nodes_y, step, taps;
    uint key;                          // coverage: where to write
    uint first_key, second_key;
    float blend;
    vec3 gain;
    float window_sigma;                // rad
    vec3 gaze[2];                      // of the views
};

struct NearPush {
    uint width, height, tiles_x, tiles_y;
    float near;                        // rad
    float pupil_um, halo, diffraction; // halo: share f of the light; diffraction: share of the rest that has the aperture's tail
    float angle_scale, radius, strength;
    float near_from;
    float window_sigma;                // rad
    vec3 gaze[2];
};

struct KernelPush {
    float pitch, near, radius;         // rad
    float pupil_um, particle_um, halo, diffraction;
    float angle_scale, strength;
    float patch_um;                    // width of a patch of the pupil
    uint texture_on;                   // 1: halo times the structure factor
};

struct StructurePush {
    uint first_pair, pairs;
    float pupil_radius_mm;             // pupil_sum only
};

#ifdef __cplusplus
static_assert(sizeof(GatePush) <= 128 && sizeof(GatherPush) <= 128 && sizeof(NearPush) <= 128, "push constants");
}  // namespace entoptic::perception
#endif

#endif
