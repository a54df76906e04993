// The slot `scotoma`: places of the retina that do not see. Reads: scene (cd/m², before `tone`), ObserverState, geometry, the gaze. Writes:
// scene, in place. Invariants: never brighter; none by day and none where the gaze is unknown; finite for any input.
#pragma once

#include "perception/gate.h"
#include "perception/gated_pass.h"
#include "perception/model.h"
#include "perception/observer_state.h"
