// The slot `mesopic`: the colours of dim light, where rods take over from cones. Reads: scene, ObserverState. Writes: scene, in place.
// A model acts either on scene light, before `tone` (jacobs_mesopic, mes2: rods change luminance), or on display light, after it
// (luidolt_tint, krawczyk_tint): its row of models.list says which. Invariants: finite; black stays black; with full cone vision the
// picture is unchanged to the bit. On display light R, G, B stay within [black, white] of the display, and a normalised tint keeps each
// pixel's luminance as long as nothing is clamped.
#pragma once

#include "perception/gate.h"
#include "perception/model.h"
#include "perception/observer_state.h"
