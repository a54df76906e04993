// What luidolt_spectral's C++ and its own shaders say to each other: the textured kernel. Scalar layout.
#ifndef ENTOPTIC_PERCEPTION_GLARE_LUIDOLT_SPECTRAL_GPU_H
#define ENTOPTIC_PERCEPTION_GLARE_LUIDOLT_SPECTRAL_GPU_H

#include "perception/glare/glare_gpu.h"
#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

const uint max_wavelengths = 33;       // 32, and one more end point as printed
const uint halo_table_size = 4096;     // halo over sin(theta) 0..1

const uint structure_n = 256;          // binned structure factor, two FFT bins a sample, zero frequency at (128, 128)
const uint cell_samples = 32;          // particle lists: 16 x 16 cells a patch
const uint cells_per_side = 16;
const float pupil_edge_mm = 0.11f;      // a patch counts in full when its centre is this far inside the pupil

// The spectrum, as the kernel sees it.
struct SpectralTable {
    float lambda_um[max_wavelengths];
    vec3 weight[max_wavelengths];      // of a wavelength in R, G, B; sum to `gain`
    uint count;
    vec3 mean_lambda_um;               // sum of weight * lambda
    vec3 gain;                         // energy of the whole kernel: 1, or the colour cast of eq. 9 as printed
};

struct TexturedKernelPush {
    float pitch, near, radius;         // rad
    float particle_um;
    float halo;                        // share of the light that the particles scatter, over the square of angle_scale
    float angle_scale;
    float patch_um;                    // width of a patch of the pupil
    uint texture_on;                   // 1: halo times the structure factor
    uint profile;                      // first entry of the smooth profile's far part
    vec3 weights;                      // of its parts
};

struct StructurePush {
    uint first_pair, pairs;
    float pupil_radius_mm;             // pupil_sum only
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
