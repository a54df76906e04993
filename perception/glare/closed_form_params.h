// Parameters of closed_form; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_GLARE_CLOSED_FORM_PARAMS_H
#define ENTOPTIC_PERCEPTION_GLARE_CLOSED_FORM_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct ClosedFormParams {
    float strength;                   // times the scattered light; 1 is the eye that the other parameters describe
    float age;                        // of the simulated person, years
    float pigment;                    // of the person's iris: 0 very dark, 0.5 brown, 1 green, 1.2 light blue
    float straylight_factor;          // of the person, beyond what is normal for the age: cataract
    float particle_diameter_um;       // of every particle
    float particles_per_mm2;          // of the pupil plane
    float diffraction;                // share of the light that the pupil's own edge diffracts
    float lenticular_halo;            // times the ring that the fibres of the lens make
    float straylight_colour;          // 0: white straylight; 1: bluish by (575 nm / lambda)^4, less so in light eyes
    float emission_spectra;           // 1: each primary scatters by its own spectrum, a kernel of 3 x 3 (residual form only)
    float angle_scale;                // enlarges the kernel
    float texel_px;                   // least width of a texel of the glare grid, eye-image pixels
    float near_px;                    // radius of the near field that is done at full resolution, pixels
    float near_from;                  // photographic: light above this many times the adaptation luminance has a near field
    float rebuild_mm;                 // distance of the pupil diameters at which the kernel is built; linear in between
    float wearer_age;                 // years; 0: as the person
    float wearer_pigment;             // -1: as the person
    float wearer_straylight_factor;   // 0: as the person
    float rescatter;                  // share of the wearer's own scatter of the drawn halo that is taken away
    float photographic;               // 1: the whole scene is scattered; 0: only what the wearer's eye at the panel does not scatter itself
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
