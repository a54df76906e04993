// The slot `noise`: light that is so dim that it comes in single quanta. Reads: scene (cd/m², before `tone`), ObserverState, geometry. Writes:
// scene, in place. Invariants: the mean over time and places is the picture; none by day; defined in visual angle and in seconds, around the
// gaze; two runs with one seed are alike; finite for any input, never negative.
#pragma once

#include "perception/gate.h"
#include "perception/gated_pass.h"
#include "perception/model.h"
#include "perception/observer_state.h"
