// The slot `adaptation`: what luminance the eye is adapted to. Reads: tiles, statistics, geometry, gaze, eyelid, dt. Writes:
// ObserverState of each view (adaptation_cd_m2, target_cd_m2, initialised) and SceneStatistics::gaze_y; never the scene.
// Invariants: the state is finite and at least the model's floor; a constant scene luminance Y gives A = Y in the end; the result does
// not depend on the frame rate (45..1000 frames a second, and one long frame); dt <= 0 or NaN moves nothing; `snap` and the first frame
// give A = target; every view has its own state. Adaptation is a state, so there is no gate: it advances exactly in every frame.
#pragma once

#include "perception/model.h"
#include "perception/observer_state.h"
