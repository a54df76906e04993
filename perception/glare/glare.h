// The slot `glare`: light that the eye scatters from where it belongs to everywhere else.
// Reads: scene, geometry, statistics and tiles of the unchanged scene, ObserverState::adaptation_cd_m2 and ::tone, the pupils. Writes: scene,
// in place. Linear light, cd/m², before any tone map.
//
// Two forms; W is ObserverState::tone.scene_white_cd_m2, K >= 0 and sum K < 1.
// The whole eye, for pictures (`photographic`, and models of papers): out = C + sum over y of K(x, y) (C(y) - C(x)).
//   A uniform field is unchanged; energy (luminance times solid angle) inside the image is unchanged; what lies outside the eye image is unknown,
//   each pixel takes it to be as bright as itself.
// The residual, for headsets: the wearer's own eye scatters what the panel sends, so only the rest is added, out = C + sum over y != x of
// K(x, y) max(C(y) - W, 0), less what the wearer's eye makes of the light so drawn.
//   No channel above W: nothing is done, bit for bit; no step as a lamp passes W.
// Both: no light in, no light out; the result is finite and not negative; strength 0 is recorded as nothing at all.
#pragma once

#include "perception/model.h"
