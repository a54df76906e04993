// display_identity for a scene of which only a few numbers are known. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_CURVES_DISPLAY_IDENTITY_SCENE_GLSL
#define ENTOPTIC_PERCEPTION_CURVES_DISPLAY_IDENTITY_SCENE_GLSL

#include "perception/curves/curve_settings.h"
#include "perception/tone/display_identity_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::display_identity)
#ifdef __cplusplus
using entoptic::perception::curve_settings::ToneResponse;
#endif

// Displayed luminance (cd/m²) of scene luminance y on a panel of this white and black.
FN real shown_of_scene(DisplayIdentityParams p, ToneResponse scene, real y, real white, real black) {
    ToneLevels levels;
    levels.bright_y = scene.bright > LIT(0.0) ? scene.bright : LIT(8.0) * scene.adapted_to;
    real dark = scene.dark_share >= LIT(0.0) ? scene.dark_share : (scene.adapted_to < black ? LIT(1.0) : LIT(0.0));
    levels.night_weight = night_weight(dark);
    levels.day_weight = day_weight(levels.bright_y, white);
    levels.shoulder = LIT(0.0);
    real e = exposure(p, levels, scene.adapted_to, white);
    return displayed(p, y, e, shoulder(scene.peak > LIT(0.0) ? scene.peak : levels.bright_y, e, white), white);
}

ENTOPTIC_MATH_END

#endif
