// State of the observer that models share, one a view. Scalar layout, one struct for C++ and GLSL.
#ifndef ENTOPTIC_PERCEPTION_OBSERVER_STATE_H
#define ENTOPTIC_PERCEPTION_OBSERVER_STATE_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::perception {
#endif

// The tone curve of this frame, tabulated over log10 luminance from -6 to 8: where other models learn what the panel will show.
const uint tone_points_per_decade = 8;
const uint tone_points = 113;

// Written by the tone model's plan() before any model changes the picture; without a tone model by the stage: the panel's range as it is.
struct ToneCurve {
    float exposure;             // e: displayed over scene luminance on the curve's straight part, or at A where it has none; 1: as it is
    float straight_until_cd_m2; // displayed luminance is exactly e·Y up to this scene luminance; 0 where the curve has no straight part
    float scene_white_cd_m2;    // W: a channel brighter than this in the scene cannot be shown truthfully (panel white over e)
    float log10_displayed[tone_points];   // log10 of displayed luminance (cd/m²) at log10 Y = -6 + i / tone_points_per_decade
};

struct ObserverState {
    float adaptation_cd_m2;     // A: what the eye is adapted to; 0 before the first frame
    float target_cd_m2;         // where it goes: gaze-weighted luminance of this frame
    uint initialised;           // 0 before the first frame
    // Of the tone model, smoothed over time; 0 before its first frame.
    float bright_y;             // 99.9th percentile of luminance, cd/m²
    float night_weight, day_weight, shoulder;    // how far the picture is exposed for the dark, for the light; highlights compressed: 0..1
    ToneCurve tone;
};

#ifdef __cplusplus
static_assert(sizeof(ObserverState) == 4 * (7 + 3 + tone_points), "scalar layout: the GLSL side must agree");
}  // namespace entoptic::perception
#endif

#endif
