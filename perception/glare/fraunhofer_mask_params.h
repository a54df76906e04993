// Parameters of fraunhofer_mask; one struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_PERCEPTION_GLARE_FRAUNHOFER_MASK_PARAMS_H
#define ENTOPTIC_PERCEPTION_GLARE_FRAUNHOFER_MASK_PARAMS_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct FraunhoferMaskParams {
    float strength;             // times the diffracted light
    float blades;               // of a diaphragm in the pupil's place; under 3: the round pupil
    float blade_rotation_deg;   // of the diaphragm's first corner from the right, counter-clockwise
    float lashes;               // eyelashes on 10 mm of the upper lid; 0: none
    float lash_width_mm;
    float lash_length_mm;
    float lash_curl;            // of the closed eye; 0: hang straight down .. 1: come up again to the lid, as those of the open eye do
    float lash_seed;
    float lids;                 // 1: the eyelids are obstacles, opened by EyeInput::eyelid_open
    float lid_open;             // times EyeInput::eyelid_open
    float filter_directions;    // of the lines of a cross-screen filter; 0: no filter
    float filter_spacing_mm;    // between lines
    float filter_width_mm;      // of a line
    float filter_rotation_deg;
    float mask_width_mm;        // full width of the image `mask` in the pupil's plane
    float obstacle_mm;          // from the pupil forward to lashes, lids, filter and image
    float zones;                // across the view, each with the obstacles as light from there sees them
    float wavelengths;          // samples of 400..700 nm
    float three_lines;          // 1: the paper's 680, 530 and 460 nm
    float pupil_step_mm;        // pupil diameters at which kernels are built
    float lid_steps;            // openings of the lids at which kernels are built
    float texel_px;             // least width of a texel of the glare grid, eye-image pixels
    float near_px;              // radius that is done at full resolution, pixels
    float billboard_texels;     // up to so many lit texels the kernel is drawn at each, else by transforms
    float sigmoid;              // 1: the veil goes through the paper's tone curve (eq. 7 corrected)
    float photographic;         // 1: the whole scene diffracts; 0: only what the panel cannot show
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
