// The upper lid comes down over the pupil. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_EYELID_BLINK_MATH_GLSL
#define ENTOPTIC_PERCEPTION_EYELID_BLINK_MATH_GLSL

#include "perception/eyelid/blink_params.h"
#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::blink)

// Share of the pupil's area below the lid's edge: the edge is straight, `open` (0..1) of the slit's height above its lower end, and the pupil
// in the middle of the slit. Not finite: open.
FN real uncovered(BlinkParams p, real open, real pupil_mm) {
    if (!(open < LIT(1.0))) return LIT(1.0);
    real t = (max(open, LIT(0.0)) - LIT(0.5)) * real(p.opening_mm) / (LIT(0.5) * pupil_mm);
    if (!(t < LIT(1.0))) return LIT(1.0);
    if (t <= LIT(-1.0)) return LIT(0.0);
    // The circular segment above the edge.
    return LIT(1.0) - (acos(t) - t * sqrt(LIT(1.0) - t * t)) * LIT(0.3183098861837907);
}

// What light is multiplied with: past the lid, and through it.
FN rvec3 passed(BlinkParams p, real open, real pupil_mm) {
    real past = uncovered(p, open, pupil_mm), through = LIT(1.0) - past;
    return rvec3(past + through * real(p.lid_red), past + through * real(p.lid_green_blue), past + through * real(p.lid_green_blue));
}

ENTOPTIC_MATH_END

#endif
