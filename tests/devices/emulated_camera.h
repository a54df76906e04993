// A UVC camera of motion JPEG pictures on the kernel's USB: isochronous, high speed. Source of the descriptors: USB Device Class Definition
// for Video Devices 1.0, and what Pupil Labs' cameras offer (facts/devices.md 3).
#pragma once

#include "tests/devices/emulated_usb.h"

#include <functional>

namespace entoptic::devices {

struct CameraOffer {
    int width = 192, height = 192, rate_hz = 200;
};

class EmulatedCamera final : public EmulatedUsb {
public:
    // `picture` makes the JPEG of frame n since the stream began, from the device's thread; empty: the frame is skipped. It may be damaged or cut.
    using Picture = std::function<Bytes(const CameraOffer& offer, std::int64_t n)>;
    // No two cameras plugged in together may have the same serial number.
    EmulatedCamera(const std::string& product, const std::string& serial, std::vector<CameraOffer> offers, Picture picture);
    // Before it is plugged in.
    void set_picture(Picture picture) { picture_ = std::move(picture); }

    std::atomic<std::int64_t> frames = 0;  // sent, since it was made
    std::atomic<int> starts = 0;           // of its stream
    std::atomic<int> alternate = 0;        // setting of the streaming interface that the host chose last: how much of the bus it reserved
    std::atomic<int> exposure_100us = 32;  // as the host has set it
    // Faults to order.
    std::atomic<bool> frozen = false;     // sends empty packets only
    std::atomic<int> lost_packets = 0;    // the next so many packets with a piece of a picture do not arrive
    std::atomic<int> stalled_starts = 0;  // the next so many times the host commits to a format are answered with a STALL

private:
    std::optional<Bytes> control_in(const Setup& setup) override;
    bool control_out(const Setup& setup, std::span<const std::uint8_t> data) override;
    InAnswer in(int, TimeNs) override { return {InAnswer::Kind::stall, {}, -1}; }
    InAnswer in_packets(int endpoint, std::span<IsoPacket> packets, TimeNs now) override;
    void set_interface(int interface, int alternative) override;
    void plugged_in() override { streaming_ = false; }
    bool commit(std::span<const std::uint8_t> data, bool start);

    const CameraOffer& offer() const;
    DurationNs frame_period() const;
    void negotiate(std::uint8_t frame, std::uint32_t interval);
    bool has_data(TimeNs now);
    void put_payload(Bytes& out, IsoPacket& packet);

    std::vector<CameraOffer> offers_;
    Picture picture_;
    Bytes probe_ = Bytes(26, 0);  // VIDEO_PROBE and COMMIT control
    bool streaming_ = false;
    TimeNs start_ = 0;
    std::int64_t microframe_ = 0, next_frame_ = 0;
    Bytes current_;
    std::size_t sent_ = 0;  // of current_
    std::uint8_t frame_id_ = 0;
    std::uint8_t exposure_mode_ = 8;
};

}  // namespace entoptic::devices
