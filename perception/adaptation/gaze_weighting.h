// How the luminance that drives adaptation is weighted; the part that the parameters of all adaptation models have in common.
#ifndef ENTOPTIC_PERCEPTION_ADAPTATION_GAZE_WEIGHTING_H
#define ENTOPTIC_PERCEPTION_ADAPTATION_GAZE_WEIGHTING_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

struct GazeParams {
    float sigma_gaze_deg;    // standard deviation of the Gaussian around the gaze, degrees of visual angle
    float wide_share;        // share 0..1 of the whole field's mean in the target, when the source is before the eye's optics
    float floor_cd_m2;       // the eye never adapts below this
    float clip_over_median;  // tiles brighter than this times the median tile count as that much
    float retinal;           // 1: the light on the fovea, with the straylight of the whole field; 0: the scene's
    float as_printed;        // 1: weights that are not normalised (trap L2), pixels instead of solid angle, no wide field, no clip
};

#ifdef __cplusplus
}  // namespace entoptic::perception
#endif

#endif
