// HID devices: found by USB identity, read and written through the kernel (hidraw, by hidapi). An interface, so that tests bring their own.
#pragma once

#include "base/result.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace entoptic::drivers {

struct HidInfo {
    std::string path;  // to open: "/dev/hidraw3"
    std::uint16_t vendor = 0, product = 0;
    int interface = -1;  // of the USB device; -1 unknown
    std::string serial;
    std::string usb_path;  // of the USB device in its bus's tree: "3-1.4"; empty where it is on no USB
};

class HidDevice {
public:
    virtual ~HidDevice() = default;
    // Waits at most `timeout_ms` for an input report (its id first). 0 bytes: none came. Error: the device is gone.
    virtual Result<std::size_t> read(std::span<std::uint8_t> report, int timeout_ms) = 0;
    // report[0] is the id on entry. Returns the number of bytes with the id; an error when the device refuses (STALL) or is gone.
    virtual Result<std::size_t> get_feature(std::span<std::uint8_t> report) = 0;
    virtual Result<void> send_feature(std::span<const std::uint8_t> report) = 0;
};

class HidBus {
public:
    virtual ~HidBus() = default;
    // Devices of a vendor that are there now, whether or not they can be opened.
    virtual std::vector<HidInfo> list(std::uint16_t vendor) = 0;
    // ErrorKind::missing with what to do when permissions do not allow it.
    virtual Result<std::unique_ptr<HidDevice>> open(const HidInfo& info) = 0;
};

// The machine's own.
HidBus& system_hid_bus();

}  // namespace entoptic::drivers
