// Where the two eyes' lines of sight meet.
#pragma once

#include "base/pose.h"
#include "interfaces/observer.h"

#include <algorithm>
#include <array>

namespace entoptic {

constexpr float nearest_vergence_dioptre = 20;  // 5 cm: nearer than anybody focuses

// 1/m, 0 to nearest_vergence_dioptre; negative when not both eyes are measured. Vertical misalignment is not looked at.
inline float vergence_dioptre(const Observer& observer, const std::array<Pose, 2>& head_from_eye) {
    const auto& [left, right] = observer.eyes;
    const float apart_m = head_from_eye[1].position.x - head_from_eye[0].position.x;
    if (left.gaze_provenance != Provenance::measured || right.gaze_provenance != Provenance::measured || !(apart_m > 0)) return -1;
    if (!(left.gaze_direction.z < 0 && right.gaze_direction.z < 0)) return -1;
    const auto tangent = [](const glm::vec3& gaze) { return gaze.x / -gaze.z; };
    return std::clamp((tangent(left.gaze_direction) - tangent(right.gaze_direction)) / apart_m, 0.0f, nearest_vergence_dioptre);
}

}  // namespace entoptic
