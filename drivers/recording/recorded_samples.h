// Samples to the payloads of a recording and back. Pure; payloads are untrusted: a wrong length is none.
#pragma once

#include "interfaces/sources.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace entoptic::drivers {

using Payload = std::vector<std::uint8_t>;

Payload encode_pose(TimeNs time, const PoseState& state);
struct RecordedPose {
    TimeNs time = 0;  // that the pose is of
    PoseState state;
};
std::optional<RecordedPose> decode_pose(std::span<const std::uint8_t> payload);

Payload encode_eye(int eye, const RawEyeSample& sample);
struct RecordedEye {
    int eye = 0;          // 0 left, 1 right
    RawEyeSample sample;  // numbers as they came: may be NaN
};
std::optional<RecordedEye> decode_eye(std::span<const std::uint8_t> payload);

}  // namespace entoptic::drivers
