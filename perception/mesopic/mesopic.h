// The slot `mesopic`: the colours of dim light, where rods take over from cones. Reads: scene (display light), ObserverState. Writes:
// scene, in place. Invariants: R, G, B stay within [black, white] of the display and finite; black stays black; with full cone vision the picture
// is unchanged; a normalised tint keeps each pixel's luminance as long as nothing is clamped.
#pragma once

#include "perception/gate.h"
#include "perception/model.h"
#include "perception/observer_state.h"
