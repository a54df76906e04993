// The slot `glare`: light that the eye scatters from where it belongs to everywhere else.
// Reads: scene, geometry, statistics and tiles of the unchanged scene, ObserverState::adaptation_cd_m2, the pupils. Writes: scene, in place.
// Linear light, cd/m², before any tone map.
//
// Invariants of every model, out = C + sum over y of K(x, y) (C(y) - C(x)) with K >= 0 and sum K < 1:
//   a uniform field is unchanged; energy (luminance times solid angle) inside the image is unchanged;
//   no light in, no light out, bit for bit; a brighter source never lowers any pixel; the result is finite and not negative;
//   strength 0 is recorded as nothing at all.
// What lies outside the eye image is unknown; each pixel takes it to be as bright as itself, which is what the form above says.
#pragma once

#include "perception/model.h"
