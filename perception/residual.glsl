// The residual law: what the panel can show is shown as it is; a simulation adds only the difference between an eye in the scene and the
// wearer's eye at the panel. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_RESIDUAL_GLSL
#define ENTOPTIC_PERCEPTION_RESIDUAL_GLSL

#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception)

// Luminance of one place for both eyes, cd/m².
struct BothEyes {
    real scene, panel;
};

// The panel cannot go below its black: what it would show darker is taken as the luminance that it shows as black, for both eyes, so that
// an exposure of 1 leaves no difference anywhere. `scene` above 0.
FN BothEyes above_black(real scene, real displayed, real black) {
    real lift = displayed < black ? black / max(displayed, LIT(1e-20)) : LIT(1.0);
    BothEyes eyes;
    eyes.scene = scene * lift;
    eyes.panel = displayed * lift;
    return eyes;
}

// Cones' share to simulate, from that in the scene and the wearer's own at the panel: the wearer's eye does the rest.
FN real residual_share(real scene, real panel) { return scene < panel ? max(scene, LIT(0.0)) / panel : LIT(1.0); }

ENTOPTIC_MATH_END

#endif
