// The slot `dof`: what the eye is not focused on is blurred, by a disc as wide as the pupil makes it. Reads: scene (cd/m², before `tone`),
// dioptre, geometry, solid angle. Writes: scene, in place. Invariants: without a known depth nothing changes, not a bit; a constant picture
// is unchanged; light of a plane of one depth is only moved, none is made or lost; what is sharp takes no light from what lies behind it; the
// blur is defined in visual angle; finite for any input.
#pragma once

#include "perception/gate.h"
#include "perception/model.h"
