#include "tests/devices/emulated_camera.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace entoptic::devices {

namespace {

constexpr std::uint16_t vendor = 0x0c45, product_id = 0x64ab;
constexpr DurationNs microframe = 125'000;
// Alternate settings 1 to 6: transactions a microframe, and bytes of each (facts/devices.md 3.4).
struct Alternate {
    std::uint32_t transactions, bytes;
};
constexpr std::array alternates{Alternate{1, 128}, Alternate{1, 256}, Alternate{1, 800}, Alternate{2, 800}, Alternate{3, 800}, Alternate{3, 1024}};
// What the cameras ask for is the largest of them, whatever their pictures need. (The real ones ask for 3640, which the kernel takes for that.)
constexpr std::uint32_t largest_payload = 3 * 1024;
constexpr std::size_t payload_header = 2;
constexpr std::uint8_t streaming_interface = 1, camera_terminal = 1, processing_unit = 2;
constexpr std::uint8_t set_cur = 1, get_cur = 0x81, get_min = 0x82, get_max = 0x83, get_res = 0x84, get_len = 0x85, get_info = 0x86,
                       get_def = 0x87;

void append(Bytes& to, std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) to.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}
void append(Bytes& to, const Bytes& more) { to.insert(to.end(), more.begin(), more.end()); }
void put(Bytes& to, std::size_t at, std::uint32_t value) { std::memcpy(&to[at], &value, 4); }
std::uint32_t interval_100ns(int rate_hz) { return static_cast<std::uint32_t>(10'000'000 / rate_hz); }

Bytes control_interface() {
    Bytes out{13, 0x24, 1, 0, 1, 0, 0, 0x80, 0x8d, 0x5b, 0, 1, 1};                             // UVC 1.0, 6 MHz
    append(out, {18, 0x24, 2, camera_terminal, 1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0x0a, 0, 0});  // exposure mode and time
    append(out, {11, 0x24, 5, processing_unit, camera_terminal, 0, 0, 2, 0, 0, 0});            // no controls
    append(out, {9, 0x24, 3, 3, 1, 1, 0, processing_unit, 0});
    out[5] = static_cast<std::uint8_t>(out.size());
    return out;
}

Bytes streaming_formats(const std::vector<CameraOffer>& offers) {
    Bytes out{14, 0x24, 1, 1, 0, 0, 0x81, 0, 3, 0, 0, 0, 1, 0};
    append(out, {11, 0x24, 6, 1, static_cast<std::uint8_t>(offers.size()), 1, 1, 0, 0, 0, 0});  // motion JPEG
    for (std::size_t i = 0; i < offers.size(); ++i) {
        const CameraOffer& o = offers[i];
        Bytes frame{0, 0x24, 7, static_cast<std::uint8_t>(i + 1), 0};
        append(frame, static_cast<std::uint64_t>(o.width), 2);
        append(frame, static_cast<std::uint64_t>(o.height), 2);
        append(frame, static_cast<std::uint64_t>(o.width * o.height * 8 * 30), 4);
        append(frame, static_cast<std::uint64_t>(o.width * o.height * 8 * o.rate_hz), 4);
        append(frame, static_cast<std::uint64_t>(o.width * o.height * 2), 4);
        append(frame, interval_100ns(o.rate_hz), 4);
        frame.push_back(2);
        append(frame, interval_100ns(o.rate_hz), 4);
        append(frame, interval_100ns(30), 4);
        frame[0] = static_cast<std::uint8_t>(frame.size());
        append(out, frame);
    }
    append(out, {6, 0x24, 13, 1, 1, 4});
    out[4] = static_cast<std::uint8_t>(out.size());
    out[5] = static_cast<std::uint8_t>(out.size() >> 8);
    return out;
}

UsbDescriptors descriptors(const std::string& product, const std::string& serial, const std::vector<CameraOffer>& offers) {
    UsbDescriptors out = usb_descriptors(vendor, product_id, {"Pupil Labs", product, serial});
    out.device[4] = 0xef, out.device[5] = 2, out.device[6] = 1;  // interface association
    Bytes& c = out.configuration;
    append(c, {8, 11, 0, 2, 14, 3, 0, 0, 9, 4, 0, 0, 0, 14, 1, 0, 0});
    append(c, control_interface());
    append(c, {9, 4, streaming_interface, 0, 0, 14, 2, 0, 0});
    append(c, streaming_formats(offers));
    for (std::size_t i = 0; i < alternates.size(); ++i) {
        append(c, {9, 4, streaming_interface, static_cast<std::uint8_t>(i + 1), 1, 14, 2, 0, 0, 7, 5, 0x81, 5});
        append(c, alternates[i].bytes | (alternates[i].transactions - 1) << 11, 2);
        c.push_back(1);
    }
    c[2] = static_cast<std::uint8_t>(c.size());
    c[3] = static_cast<std::uint8_t>(c.size() >> 8);
    c[4] = 2;
    return out;
}

}  // namespace

EmulatedCamera::EmulatedCamera(const std::string& product, const std::string& serial, std::vector<CameraOffer> offers, Picture picture)
    : EmulatedUsb(descriptors(product, serial, offers)), offers_(std::move(offers)), picture_(std::move(picture)) {
    negotiate(1, 0);
}

const CameraOffer& EmulatedCamera::offer() const { return offers_[static_cast<std::size_t>(probe_[3] - 1)]; }

DurationNs EmulatedCamera::frame_period() const {
    std::uint32_t interval = 0;
    std::memcpy(&interval, &probe_[4], 4);
    return static_cast<DurationNs>(interval) * 100;
}

void EmulatedCamera::negotiate(std::uint8_t frame, std::uint32_t interval) {
    probe_[2] = 1;
    probe_[3] = static_cast<std::uint8_t>(std::clamp<int>(frame, 1, static_cast<int>(offers_.size())));
    const CameraOffer& o = offer();
    put(probe_, 4, interval > interval_100ns(60) ? interval_100ns(30) : interval_100ns(o.rate_hz));
    put(probe_, 18, static_cast<std::uint32_t>(o.width * o.height * 2));
    put(probe_, 22, largest_payload);
}

void EmulatedCamera::set_interface(int interface, int alternative) {
    if (interface != streaming_interface) return;
    streaming_ = alternative > 0 && alternative <= static_cast<int>(alternates.size());
    if (streaming_) alternate = alternative;
    if (streaming_) ++starts;
    start_ = monotonic_now();
    microframe_ = next_frame_ = 0;
    current_.clear();
    sent_ = 0;
}

std::optional<Bytes> EmulatedCamera::control_in(const Setup& s) {
    const int selector = s.value >> 8, entity = s.index >> 8, interface = s.index & 255;
    if (s.type != 0xa1) return std::nullopt;
    if (interface == streaming_interface && (selector == 1 || selector == 2)) {
        if (s.request == get_len) return Bytes{26, 0};
        if (s.request == get_info) return Bytes{3};
        return probe_;
    }
    if (entity != camera_terminal) return std::nullopt;
    if (selector == 2) {  // exposure mode: 1 manual, 8 aperture priority
        if (s.request == get_len) return Bytes{1, 0};
        if (s.request == get_info) return Bytes{3};
        return Bytes{s.request == get_res ? std::uint8_t(9) : s.request == get_cur ? exposure_mode_ : std::uint8_t(8)};
    }
    if (selector != 4) return std::nullopt;  // exposure time, 100 us
    if (s.request == get_len) return Bytes{4, 0};
    if (s.request == get_info) return Bytes{3};
    Bytes value;
    const std::uint32_t number = s.request == get_min || s.request == get_res ? 1
                                 : s.request == get_max                       ? 10'000
                                 : s.request == get_def                       ? 32
                                                                              : static_cast<std::uint32_t>(exposure_100us.load());
    append(value, number, 4);
    return value;
}

// VIDEO_PROBE, or with `start` VIDEO_COMMIT.
bool EmulatedCamera::commit(std::span<const std::uint8_t> data, bool start) {
    std::uint32_t interval = 0;
    if (data.size() < 8) return false;
    if (start && stalled_starts > 0) return --stalled_starts, false;
    std::memcpy(&interval, &data[4], 4);
    negotiate(data[3], interval);
    return true;
}

bool EmulatedCamera::control_out(const Setup& s, std::span<const std::uint8_t> data) {
    const int selector = s.value >> 8, entity = s.index >> 8, interface = s.index & 255;
    if (s.type != 0x21 || s.request != set_cur) return false;
    if (interface == streaming_interface && (selector == 1 || selector == 2)) return commit(data, selector == 2);
    if (entity != camera_terminal) return false;
    if (selector == 2 && !data.empty()) return exposure_mode_ = data[0], true;
    if (selector != 4 || data.size() < 4) return false;
    std::uint32_t value = 0;
    std::memcpy(&value, data.data(), 4);
    exposure_100us = static_cast<int>(value);
    return true;
}

// Is there something of a picture to send at bus time `now`? Frame ids alternate (2.4.3.2.2 of that definition).
bool EmulatedCamera::has_data(TimeNs now) {
    while (sent_ >= current_.size()) {
        if (frozen) next_frame_ = std::max(next_frame_, (now - start_) / frame_period() + 1);
        if (start_ + next_frame_ * frame_period() > now) return false;
        current_ = picture_(offer(), next_frame_++);
        sent_ = 0;
        if (!current_.empty()) frame_id_ ^= 1;
    }
    return true;
}

// The picture's next piece; of a packet that is lost nothing arrives.
void EmulatedCamera::put_payload(Bytes& out, IsoPacket& packet) {
    const Alternate& reserved = alternates[static_cast<std::size_t>(alternate - 1)];
    const std::size_t room = std::min(packet.length, reserved.transactions * reserved.bytes) - payload_header;
    const std::size_t length = std::min(room, current_.size() - sent_);
    const bool last = sent_ + length == current_.size();
    if (lost_packets > 0) {
        --lost_packets;
        packet.status = static_cast<std::uint32_t>(-EXDEV);
    } else {
        append(out, Bytes{payload_header, static_cast<std::uint8_t>(0x80 | frame_id_ | (last ? 2 : 0))});
        out.insert(out.end(), current_.begin() + static_cast<std::ptrdiff_t>(sent_),
                   current_.begin() + static_cast<std::ptrdiff_t>(sent_ + length));
        packet.actual = static_cast<std::uint32_t>(payload_header + length);
    }
    sent_ += length;
    if (last) ++frames;
}

// A transfer is done when the bus would have carried its last microframe.
InAnswer EmulatedCamera::in_packets(int, std::span<IsoPacket> packets, TimeNs now) {
    if (!streaming_) return {InAnswer::Kind::wait, {}, -1};
    const TimeNs end = start_ + (microframe_ + static_cast<std::int64_t>(packets.size())) * microframe;
    if (now < end) return {InAnswer::Kind::wait, {}, end};
    Bytes data;
    for (IsoPacket& packet : packets) {
        const TimeNs time = start_ + microframe_++ * microframe;
        if (has_data(time)) {
            put_payload(data, packet);
        } else {
            append(data, Bytes{payload_header, static_cast<std::uint8_t>(0x80 | frame_id_)});
            packet.actual = payload_header;
        }
    }
    return {InAnswer::Kind::data, std::move(data), -1};
}

}  // namespace entoptic::devices
