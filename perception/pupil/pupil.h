// The slot `pupil`: from the pupil that is measured (or scripted) to that of the eye which is simulated. Reads: the measured diameter, last frame's
// mean luminance in the scene and on the panel. Writes: EyeInput::pupil_diameter_mm of each view.
// Invariants: finite and within 1.5..9 mm for any input; no GPU work; no gate.
#pragma once

#include "perception/model.h"
