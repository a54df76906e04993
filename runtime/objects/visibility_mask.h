// What of an eye's view the lens shows, as meshes in the view's plane at z = -1 (XR_KHR_visibility_mask).
#pragma once

#include "interfaces/headset.h"

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace entoptic::runtime {

struct Mesh {
    std::vector<glm::vec2> vertices;  // tangents to the right and up
    std::vector<std::uint32_t> indices;
};

// The border of what the lens shows through any of its colours, counter-clockwise about the view's axis.
Mesh visible_border(const EyeOptics& optics);
// Counter-clockwise triangles over what it shows, and over what it hides of the view's field.
Mesh visible_area(const EyeOptics& optics);
Mesh hidden_area(const EyeOptics& optics);

}  // namespace entoptic::runtime
