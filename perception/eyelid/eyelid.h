// The slot `eyelid`: the lid in front of the pupil. Reads: EyeInput::eyelid_open and the pupil. Writes: scene (cd/m²), in place, after
// all that observes the retina's light, which knows of the lid itself, and before `tone`. Adaptation is held during a blink (decision 7).
// Invariants: an open eye changes nothing, not a bit; never brighter; finite for any input.
#pragma once

#include "perception/gate.h"
#include "perception/gated_pass.h"
#include "perception/model.h"
#include "perception/observer_state.h"
