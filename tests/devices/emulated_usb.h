// A USB device in user space, attached to the kernel's own USB stack: the device's side of USB/IP, whose host side is the kernel's virtual
// host controller (vhci_hcd). Wire format: the kernel's Documentation/usb/usbip_protocol.rst.
#pragma once

#include "base/result.h"
#include "base/time.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace entoptic::devices {

using Bytes = std::vector<std::uint8_t>;

struct Setup {
    std::uint8_t type = 0, request = 0;
    std::uint16_t value = 0, index = 0, length = 0;
};

// What a device says of itself.
struct UsbDescriptors {
    Bytes device, configuration;
    std::vector<std::string> strings;  // number 1 on
};
UsbDescriptors usb_descriptors(std::uint16_t vendor, std::uint16_t product, std::vector<std::string> strings);  // no interfaces yet

// Answer to an IN request on an endpoint: data, a STALL, or not yet.
struct InAnswer {
    enum class Kind { data, stall, wait } kind = Kind::wait;
    Bytes data;
    TimeNs due = -1;  // of wait: when to ask again; -1 when something else happens
};

// A packet of an isochronous transfer: room for `length` bytes, of which `actual` were sent.
struct IsoPacket {
    std::uint32_t offset = 0, length = 0, actual = 0, status = 0;
};

class EmulatedUsb {
public:
    explicit EmulatedUsb(UsbDescriptors descriptors) : descriptors_(std::move(descriptors)) {}
    virtual ~EmulatedUsb();
    EmulatedUsb(const EmulatedUsb&) = delete;
    EmulatedUsb& operator=(const EmulatedUsb&) = delete;

    // Plugs it into port 0..7 of the virtual hub. Errors: there is no vhci_hcd, or it refused.
    Result<void> plug(int port);
    void unplug();  // and waits until the port can be used again
    bool plugged() const { return socket_ >= 0; }

protected:
    // Called from the device's thread only, while it is plugged.
    // Requests beyond the standard ones. nullopt / false: STALL.
    virtual std::optional<Bytes> control_in(const Setup& setup) = 0;
    virtual bool control_out(const Setup& setup, std::span<const std::uint8_t> data) = 0;
    virtual InAnswer in(int endpoint, TimeNs now) = 0;
    // An isochronous request: fills `packets` and returns their data, one after the other without gaps.
    virtual InAnswer in_packets(int endpoint, std::span<IsoPacket> packets, TimeNs now);
    virtual void set_interface(int, int /*alternative*/) {}
    virtual void plugged_in() {}
    UsbDescriptors descriptors_;

private:
    struct Request {
        std::uint32_t sequence = 0;
        std::uint32_t length = 0;
        std::vector<IsoPacket> packets;  // empty: not isochronous
    };
    void run();
    bool handle_message();
    void handle_control(std::uint32_t sequence, bool to_host, const Setup& setup, std::span<const std::uint8_t> data);
    std::optional<Bytes> standard_in(const Setup& setup);
    void reply(std::uint32_t sequence, std::int32_t status, bool to_host, std::span<const std::uint8_t> data, std::size_t actual,
               std::span<const IsoPacket> packets = {});
    TimeNs serve(TimeNs now);
    bool receive(void* into, std::size_t bytes);

    std::map<int, std::deque<Request>> waiting_;  // by endpoint
    std::uint8_t configuration_ = 0;
    int socket_ = -1, port_ = -1;
    std::thread thread_;
};

TimeNs monotonic_now();

}  // namespace entoptic::devices
