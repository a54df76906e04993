// USB Video Class (UVC 1.1, USB Implementers Forum 2005) as far as a motion JPEG camera needs it: descriptors, the probe and commit control,
// payload headers. Bytes to structs and back: no input or output, no clock.
#pragma once

#include "base/result.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace entoptic::drivers::uvc {

// A size that the camera offers as motion JPEG. Frame intervals in 100 ns, shortest first.
struct Frame {
    std::uint8_t format_index = 0, frame_index = 0;
    int width = 0, height = 0;
    std::vector<std::uint32_t> intervals;
};

// The class-specific descriptors of the streaming interface (table 3-17 on). What is malformed is left out; sizes are bounded.
std::vector<Frame> parse_streaming_descriptors(std::span<const std::uint8_t> bytes);

// Entities of the control interface that own controls; 0 when there is none.
struct Entities {
    std::uint8_t camera_terminal = 0, processing_unit = 0;
};
Entities parse_control_descriptors(std::span<const std::uint8_t> bytes);

// VS_PROBE_CONTROL and VS_COMMIT_CONTROL (table 4-47): 26 bytes in UVC 1.0, 34 in 1.1.
constexpr std::size_t probe_bytes = 34, probe_bytes_1_0 = 26;
struct Probe {
    std::uint8_t format_index = 0, frame_index = 0;
    std::uint32_t interval = 0;           // 100 ns
    std::uint32_t max_frame_bytes = 0;    // as the camera answers
    std::uint32_t max_payload_bytes = 0;  // what the camera wants of the bus; Pupil Labs' say 3640 whatever they need
};
std::array<std::uint8_t, probe_bytes> encode(const Probe& probe);
Result<Probe> parse_probe(std::span<const std::uint8_t> bytes);

// Bytes in one microframe for this size and rate at `factor` bits a pixel (facts/devices.md 3.4: 2.0 is ample, 0.3 starves), with a header.
std::uint32_t estimated_payload(int width, int height, double rate_hz, double factor);

// An alternate setting of the streaming interface: how much of each microframe it reserves.
struct AlternateSetting {
    int number = 0;
    std::uint8_t endpoint = 0;
    std::uint32_t bytes = 0;
};
// wMaxPacketSize of a high-speed isochronous endpoint to bytes a microframe (USB 2.0, 9.6.6: bits 12..11 are additional transactions).
std::uint32_t bytes_of_packet_size(std::uint16_t max_packet_size);
// The smallest with at least `needed` bytes, else the largest; none when there is none with any.
std::optional<AlternateSetting> choose_alternate(std::span<const AlternateSetting> settings, std::uint32_t needed);

// Puts the payloads of isochronous packets (each with a header, table 2-5) together to pictures.
class PictureAssembler {
public:
    explicit PictureAssembler(std::size_t largest_picture) : largest_(largest_picture) {}

    // One packet. True when a picture has become complete: picture() is valid until the next call.
    bool feed(std::span<const std::uint8_t> packet);
    std::span<const std::uint8_t> picture() const { return finished_; }
    bool begun() const { return !collecting_.empty(); }
    std::uint64_t corrupt() const { return corrupt_; }  // pictures dropped: error bit, bad header, too long

private:
    bool finish();

    std::size_t largest_;
    std::vector<std::uint8_t> collecting_, finished_;
    std::optional<bool> frame_id_;
    bool bad_ = false;
    std::uint64_t corrupt_ = 0;
};

}  // namespace entoptic::drivers::uvc
