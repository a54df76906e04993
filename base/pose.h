// Rigid poses. Names say frames: `world_from_head` maps head coordinates to world coordinates.
// Axes are OpenXR's: x right, y up, -z forward; metres.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace entoptic {

struct Pose {
    glm::quat orientation{1, 0, 0, 0};  // w, x, y, z
    glm::vec3 position{0};              // m

    glm::vec3 transform(glm::vec3 point) const { return orientation * point + position; }
    glm::vec3 rotate(glm::vec3 direction) const { return orientation * direction; }
    Pose inverse() const {
        const glm::quat back = glm::conjugate(orientation);
        return {back, -(back * position)};
    }
};

// a_from_b * b_from_c = a_from_c
inline Pose operator*(const Pose& a, const Pose& b) { return {glm::normalize(a.orientation * b.orientation), a.transform(b.position)}; }

// Field of view as OpenXR has it: signed angles in radians, left and down negative for an eye that looks forward.
struct Fov {
    float angle_left = 0, angle_right = 0, angle_up = 0, angle_down = 0;
};

}  // namespace entoptic
