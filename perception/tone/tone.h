// The slot `tone`: from scene light to display light. Reads: scene, ObserverState::adaptation_cd_m2. Writes: scene, in place.
// Invariants: R, G, B within [black, white] of the display and finite for any finite input; a neutral pixel stays neutral; brighter
// pixels never become darker; the same adaptation gives the same map everywhere in a view.
#pragma once

#include "perception/model.h"
