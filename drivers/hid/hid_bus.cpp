#include "drivers/hid/hid_bus.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fmt/format.h>
#include <hidapi/hidapi.h>
#include <mutex>
#include <unistd.h>

namespace entoptic::drivers {

namespace {

namespace fs = std::filesystem;

// hidapi keeps global state, and says nowhere that enumeration and opening may run side by side.
std::mutex hidapi_mutex;

std::string narrow(const wchar_t* text) {
    std::string out;
    for (; text && *text && out.size() < 64; ++text) out += *text > 31 && *text < 127 ? static_cast<char>(*text) : '?';
    return out;
}

// /sys/class/hidraw/hidraw3 leads to .../usb3/3-1/3-1.4/3-1.4:1.0/0003:28DE:2300.0005/hidraw/hidraw3: the USB device is the part before
// the one with a colon and a dot (configuration.interface).
std::string usb_path_of(const std::string& node) {
    std::error_code error;
    const fs::path device = fs::canonical("/sys/class/hidraw/" + fs::path(node).filename().string(), error);
    if (error) return "";
    std::string before;
    for (const fs::path& part : device) {
        const std::string text = part.string();
        if (const auto colon = text.find(':'); colon != std::string::npos && !before.empty() && text.compare(0, colon, before) == 0)
            return before;
        before = text;
    }
    return "";
}

class SystemHidDevice final : public HidDevice {
public:
    SystemHidDevice(hid_device* device, std::string path) : device_(device), path_(std::move(path)) {}
    ~SystemHidDevice() override { hid_close(device_); }
    SystemHidDevice(const SystemHidDevice&) = delete;
    SystemHidDevice& operator=(const SystemHidDevice&) = delete;

    Result<std::size_t> read(std::span<std::uint8_t> report, int timeout_ms) override {
        const int got = hid_read_timeout(device_, report.data(), report.size(), timeout_ms);
        if (got < 0) return failure(fmt::format("{} cannot be read any more: {}. It was probably unplugged.", path_, why()));
        return static_cast<std::size_t>(got);
    }
    Result<std::size_t> get_feature(std::span<std::uint8_t> report) override {
        const int id = report.empty() ? 0 : report[0];
        const int got = hid_get_feature_report(device_, report.data(), report.size());
        if (got < 0) return failure(fmt::format("{} did not answer to feature report {:#04x}: {}.", path_, id, why()));
        return static_cast<std::size_t>(got);
    }
    Result<void> send_feature(std::span<const std::uint8_t> report) override {
        if (hid_send_feature_report(device_, report.data(), report.size()) < 0)
            return failure(fmt::format("{} did not take feature report {:#04x}: {}.", path_, report.empty() ? 0 : report[0], why()));
        return {};
    }

private:
    std::string why() const { return narrow(hid_error(device_)); }

    hid_device* device_;
    std::string path_;
};

class SystemHidBus final : public HidBus {
public:
    std::vector<HidInfo> list(std::uint16_t vendor) override {
        const std::lock_guard lock(hidapi_mutex);
        std::vector<HidInfo> out;
        hid_device_info* first = hid_enumerate(vendor, 0);
        for (const hid_device_info* d = first; d; d = d->next) {
            const HidInfo info{d->path, d->vendor_id, d->product_id, d->interface_number, narrow(d->serial_number), usb_path_of(d->path)};
            // hidapi lists a device once for each of its usages.
            if (std::none_of(out.begin(), out.end(), [&](const HidInfo& other) { return other.path == info.path; })) out.push_back(info);
        }
        hid_free_enumeration(first);
        return out;
    }
    Result<std::unique_ptr<HidDevice>> open(const HidInfo& info) override {
        const std::lock_guard lock(hidapi_mutex);
        if (access(info.path.c_str(), R_OK | W_OK) != 0 && errno == EACCES)
            return missing(
                fmt::format("{} may not be opened by this user. Install Entoptic's udev rules, then plug the headset in again; "
                            "`entoptic doctor` says how.",
                            info.path));
        hid_device* device = hid_open_path(info.path.c_str());
        if (!device) return missing(fmt::format("{} cannot be opened: {}.", info.path, narrow(hid_error(nullptr))));
        return std::make_unique<SystemHidDevice>(device, info.path);
    }
};

}  // namespace

HidBus& system_hid_bus() {
    static SystemHidBus bus;
    return bus;
}

}  // namespace entoptic::drivers
