// Potted plants: the demo's one thing of many triangles, for what level of detail saves.
#pragma once

#include <cstdint>
#include <vector>

#include "samples/demo/office.h"

namespace samples {

// The leaves of a plant that grows from `foot`, each a patch a side of 16 x 64 cells. Deterministic.
std::vector<Patch> plant_leaves(glm::vec3 foot, std::uint32_t seed);

}  // namespace samples
