// Samples to the payloads of a recording and back. Pure; payloads are untrusted: a wrong length is none.
#pragma once

#include "interfaces/sources.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
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

// A camera's picture, compressed as it came: nothing has looked at its bytes.
struct EyePicture {
    int eye = 0;                 // 0 left, 1 right
    std::string product;         // the camera's name, at most 255 letters: decides its optics
    int width = 0, height = 0;   // as agreed with the camera, 1..65535
    TimeNs time = 0;             // of its exposure
    std::uint32_t sequence = 0;  // the camera's numbering
    std::vector<std::uint8_t> jpeg;
};
Payload encode_eye_picture(const EyePicture& picture);
std::optional<EyePicture> decode_eye_picture(std::span<const std::uint8_t> payload);

}  // namespace entoptic::drivers
