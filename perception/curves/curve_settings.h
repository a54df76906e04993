// Settings of the curves, in the order of CurveKind::settings: floats in GLSL, doubles in C++.
#ifndef ENTOPTIC_PERCEPTION_CURVES_CURVE_SETTINGS_H
#define ENTOPTIC_PERCEPTION_CURVES_CURVE_SETTINGS_H

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::curve_settings)

struct NoSettings {
    real none;
};
struct PupilDiameter {
    real age, area_deg2, eyes;
};
struct AdaptationStep {
    real from_cd_m2, to_cd_m2;
};
struct ToneResponse {
    real adapted_to;       // cd/m²
    real bright;           // 99.9th percentile of the scene, cd/m²; 0: 8 times adapted_to
    real dark_share;       // share of the field that is darker than the panel's black; negative: all or nothing, by adapted_to
    real peak;             // brightest channel of the scene, cd/m²; 0: as `bright`
};
struct AcuitySigma {
    real displayed;        // cd/m²; 0: the whole blur of an eye in the scene
    real ppd;              // pixels per degree, whose box is taken off; 0: none
};
struct Flash {
    real luminance, duration_s;
};
struct CalciumStep {
    real from_response, to_response;
};
struct BlurDisc {
    real focus_m, pupil_mm;
    real wavelength_nm;    // 0: no chromatic aberration
};
struct PolarMap {
    real max_deg;
};
struct GlarePsf {
    real pupil_mm;
    real wavelength_nm;    // 0: photopic
};

ENTOPTIC_MATH_END

#endif
