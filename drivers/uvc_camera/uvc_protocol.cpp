#include "drivers/uvc_camera/uvc_protocol.h"

#include <algorithm>
#include <fmt/format.h>

namespace entoptic::drivers::uvc {

namespace {

constexpr std::uint8_t class_specific_interface = 0x24;
constexpr std::uint8_t format_mjpeg = 0x06, frame_mjpeg = 0x07;                   // VS_ descriptor subtypes, table A-6
constexpr std::uint8_t input_terminal = 0x02, processing_unit = 0x05;             // VC_ ..., table A-5
constexpr std::uint16_t camera_terminal_type = 0x0201;                            // ITT_CAMERA, table B-2
constexpr std::uint8_t flag_frame_id = 0x01, flag_end = 0x02, flag_error = 0x40;  // BFH, table 2-5
constexpr int largest_side = 16384;

std::uint16_t u16(std::span<const std::uint8_t> b, std::size_t at) { return static_cast<std::uint16_t>(b[at] | b[at + 1] << 8); }
std::uint32_t u32(std::span<const std::uint8_t> b, std::size_t at) { return u16(b, at) | static_cast<std::uint32_t>(u16(b, at + 2)) << 16; }

void put16(std::span<std::uint8_t> b, std::size_t at, std::uint32_t value) {
    b[at] = static_cast<std::uint8_t>(value);
    b[at + 1] = static_cast<std::uint8_t>(value >> 8);
}
void put32(std::span<std::uint8_t> b, std::size_t at, std::uint32_t value) {
    put16(b, at, value);
    put16(b, at + 2, value >> 16);
}

// Calls `visit(subtype, descriptor)` for every class-specific descriptor that lies whole in `bytes`.
template <class Visit> void each_descriptor(std::span<const std::uint8_t> bytes, Visit visit) {
    while (bytes.size() >= 3) {
        const std::size_t length = bytes[0];
        if (length < 3 || length > bytes.size()) return;
        if (bytes[1] == class_specific_interface) visit(bytes[2], bytes.first(length));
        bytes = bytes.subspan(length);
    }
}

std::optional<Frame> frame_of(std::span<const std::uint8_t> d, std::uint8_t format_index) {
    if (d.size() < 26) return std::nullopt;
    Frame frame{format_index, d[3], u16(d, 5), u16(d, 7), {}};
    if (frame.width < 1 || frame.height < 1 || frame.width > largest_side || frame.height > largest_side) return std::nullopt;
    const std::size_t count = d[25] == 0 ? 1 : d[25];  // 0: a range, whose least comes first
    for (std::size_t i = 0; i < count && 26 + 4 * i + 4 <= d.size(); ++i)
        if (const std::uint32_t interval = u32(d, 26 + 4 * i); interval > 0) frame.intervals.push_back(interval);
    if (frame.intervals.empty()) return std::nullopt;
    std::sort(frame.intervals.begin(), frame.intervals.end());
    return frame;
}

}  // namespace

std::vector<Frame> parse_streaming_descriptors(std::span<const std::uint8_t> bytes) {
    std::vector<Frame> frames;
    std::uint8_t format_index = 0;
    each_descriptor(bytes, [&](std::uint8_t subtype, std::span<const std::uint8_t> d) {
        if (subtype == format_mjpeg && d.size() >= 4) format_index = d[3];
        if (subtype == frame_mjpeg && format_index != 0)
            if (auto frame = frame_of(d, format_index)) frames.push_back(std::move(*frame));
    });
    return frames;
}

Entities parse_control_descriptors(std::span<const std::uint8_t> bytes) {
    Entities entities;
    each_descriptor(bytes, [&](std::uint8_t subtype, std::span<const std::uint8_t> d) {
        if (subtype == input_terminal && d.size() >= 6 && u16(d, 4) == camera_terminal_type) entities.camera_terminal = d[3];
        if (subtype == processing_unit && d.size() >= 4) entities.processing_unit = d[3];
    });
    return entities;
}

std::array<std::uint8_t, probe_bytes> encode(const Probe& probe) {
    std::array<std::uint8_t, probe_bytes> bytes{};
    put16(bytes, 0, 1);  // bmHint: the interval is to be kept
    bytes[2] = probe.format_index;
    bytes[3] = probe.frame_index;
    put32(bytes, 4, probe.interval);
    put32(bytes, 18, probe.max_frame_bytes);
    put32(bytes, 22, probe.max_payload_bytes);
    return bytes;
}

Result<Probe> parse_probe(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < probe_bytes_1_0)
        return failure(fmt::format("The camera's probe control has {} bytes instead of {}.", bytes.size(), probe_bytes_1_0));
    return Probe{bytes[2], bytes[3], u32(bytes, 4), u32(bytes, 18), u32(bytes, 22)};
}

std::uint32_t estimated_payload(int width, int height, double rate_hz, double factor) {
    const double bytes_a_picture = static_cast<double>(width) * height / 8 * factor;
    return static_cast<std::uint32_t>(bytes_a_picture * (rate_hz + 1) / 1000 / 8) + 12;  // 8000 microframes a second; a header
}

std::uint32_t bytes_of_packet_size(std::uint16_t max_packet_size) {
    return (max_packet_size & 0x7FFu) * (1 + (max_packet_size >> 11 & 3u));
}

std::optional<AlternateSetting> choose_alternate(std::span<const AlternateSetting> settings, std::uint32_t needed) {
    const AlternateSetting* best = nullptr;
    for (const AlternateSetting& setting : settings) {
        if (setting.bytes == 0) continue;
        const bool enough = setting.bytes >= needed, best_enough = best && best->bytes >= needed;
        if (!best || (enough && (!best_enough || setting.bytes < best->bytes)) || (!enough && !best_enough && setting.bytes > best->bytes))
            best = &setting;
    }
    return best ? std::optional(*best) : std::nullopt;
}

bool PictureAssembler::finish() {
    const bool good = !bad_ && !collecting_.empty();
    if (bad_) ++corrupt_;
    bad_ = false;
    if (good) finished_.swap(collecting_);
    collecting_.clear();
    return good;
}

bool PictureAssembler::feed(std::span<const std::uint8_t> packet) {
    if (packet.empty()) return false;
    const std::size_t header = packet[0];
    if (header < 2 || header > packet.size()) {
        bad_ = bad_ || !collecting_.empty();
        return false;
    }
    const bool id = packet[1] & flag_frame_id;
    bool complete = false;
    if (frame_id_ && *frame_id_ != id) complete = finish();  // the end of the picture before was lost
    frame_id_ = id;
    if (packet[1] & flag_error) bad_ = true;
    const std::span<const std::uint8_t> payload = packet.subspan(header);
    if (collecting_.size() + payload.size() > largest_)
        bad_ = true;
    else
        collecting_.insert(collecting_.end(), payload.begin(), payload.end());
    if (packet[1] & flag_end) {
        // Two pictures at once (a lost end and this packet's own): the newer one.
        complete = finish() || complete;
        frame_id_.reset();
    }
    return complete;
}

}  // namespace entoptic::drivers::uvc
