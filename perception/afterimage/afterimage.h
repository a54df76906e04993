// The slot `afterimage`: what the retina still sees of the light before. The model observes the scene light that reaches the retina (just
// before `tone`), and acts on display light, after all others. Reads: scene, geometry, statistics, ObserverState (tone curve, adaptation).
// Writes: scene, in place. Invariants: states are kept where they are on the retina, so gaze moves the afterimage, not the other way round;
// they advance by exact exponentials, so that the frame rate does not matter, and also while the picture is gated; what has always
// looked the same has no afterimage; R, G, B stay within [black, white] of the display and finite. Under the residual law an
// application that the panel shows truthfully is unchanged, bit for bit.
#pragma once

#include "perception/gate.h"
#include "perception/model.h"
#include "perception/observer_state.h"
