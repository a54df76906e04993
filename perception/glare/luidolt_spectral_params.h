// Parameters of luidolt_spectral; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_GLARE_LUIDOLT_SPECTRAL_PARAMS_H
#define ENTOPTIC_PERCEPTION_GLARE_LUIDOLT_SPECTRAL_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct LuidoltSpectralParams {
    float strength;               // times the scattered light; 1 is the eye that the other parameters describe
    float particle_diameter_um;   // of every particle
    float particles_per_mm2;      // of the pupil plane
    float wavelengths;            // samples of the spectrum
    float diffraction;            // share of the light that the pupil's own edge diffracts, 0..1
    float patches;                // patches of the pupil whose particles give the halo its texture; 0: smooth halo
    float texel_px;               // least width of a texel of the glare grid, eye-image pixels
    float near_px;                // radius of the near field that is done at full resolution, pixels
    float near_from;              // light above this many times the adaptation luminance has a near field; 0: all light
    float rebuild_mm;             // distance of the pupil diameters at which the kernel is built; linear in between
    float angle_scale;            // enlarges the kernel
    float radius_deg;             // the kernel ends here
    float window_sigma_deg;       // Gaussian window around the gaze; 0: whole field
    float as_printed;             // 1: the paper to the letter
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
