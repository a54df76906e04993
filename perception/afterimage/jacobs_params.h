// Parameters of jacobs; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_AFTERIMAGE_JACOBS_PARAMS_H
#define ENTOPTIC_PERCEPTION_AFTERIMAGE_JACOBS_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct JacobsParams {
    float strength;              // 0..1, multiplies what is shown; the states do not know it
    float photographic;          // 1: driven by the whole scene, as in the paper; 0: by what the panel cannot show
    float j1, j2;                // strength of bleaching afterimages; exponent of adaptation afterimages
    float b1_l, b1_m, b1_s;      // bleaching of L, M, S cones, 1/s per cd/m²
    float b2_l, b2_m, b2_s;      // regeneration, 1/s
    float c2;                    // calcium efflux, 1/s; the influx c1 only sets the unit of calcium and cancels
    float alpha_floor;           // added to both sides of equation 11's fraction, share of C_max (trap J15)
    float diffusion_deg;         // rms width to which a point of the retina has blurred after 1 s, degrees (trap J16)
    float fovea_sigma_deg;       // fall-off of what is shown, degrees from the fovea
    float resolution;            // of the retina's map over the picture's, an axis
    float lid_red, lid_green_blue;   // transmission of the closed eyelid
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
