// A camera that streams motion JPEG pictures, whatever it is reached through (the kernel's driver, or libusb where that has no room).
#pragma once

#include "base/result.h"
#include "base/time.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace entoptic::drivers {

struct CameraMode {
    int width = 192, height = 192;
    double rate_hz = 200;
};

// Why a camera does not work.
enum class CameraFault {
    none,
    gone,          // unplugged, or the node is not there
    forbidden,     // no permission
    busy,          // another program streams from it
    no_bandwidth,  // the bus is full (ENOSPC): facts/devices.md 3.4
    unsuitable,    // no motion JPEG or no such size
    broken,        // anything else the kernel refuses
};

struct CameraError {
    CameraFault fault = CameraFault::none;
    std::string message;  // what happened, where, and what to do
};

template <class T> using CameraResult = tl::expected<T, CameraError>;

// One picture as it came: motion JPEG bytes that belong to the driver until the next call.
struct CompressedFrame {
    std::span<const std::uint8_t> bytes;
    TimeNs time = 0;  // CLOCK_MONOTONIC: of the start of exposure where the kernel knows it, else of the arrival's begin
    std::uint32_t sequence = 0;
};

struct CameraCounts {
    std::uint64_t frames = 0;   // given out
    std::uint64_t lost = 0;     // gaps in the kernel's numbering
    std::uint64_t corrupt = 0;  // marked as such by the kernel, empty, or longer than their buffer
    std::uint64_t out_of_order = 0;
};

// One thread at a time.
class FrameStream {
public:
    virtual ~FrameStream() = default;
    // The next good picture; none when there is none within `timeout_ms`. An error ends the stream.
    virtual CameraResult<std::optional<CompressedFrame>> next(int timeout_ms) = 0;
    virtual const CameraMode& mode() const = 0;  // as agreed with the camera
    virtual const CameraCounts& counts() const = 0;
    // Sets a control (numbers of linux/v4l2-controls.h), clamped to the camera's range. False when the camera has none such or refuses.
    // Takes 50 to 100 ms (facts/devices.md 3.3).
    virtual bool set_control(std::uint32_t id, std::int32_t value) = 0;
    // Stops and starts the stream (what mends a striped one).
    virtual CameraResult<void> restart() = 0;
};

}  // namespace entoptic::drivers
