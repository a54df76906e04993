// The slot `acuity`: fine detail is lost in dim light. Reads: scene (cd/m², before `tone`), geometry, tiles, statistics. Writes: scene, in
// place. Invariants: a constant picture is unchanged; where no pixel is dark enough nothing changes, not a bit; kernels sum to 1 over the
// visible pixels; the blur is defined in visual angle, so its width in pixels follows the local pixels per degree; finite for any input.
#pragma once

#include "perception/gate.h"
#include "perception/model.h"
