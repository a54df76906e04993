#include "drivers/vive_pro/vive_pro_device.h"

#include "base/log.h"
#include "drivers/eye_tracking/absent_eyes.h"
#include "drivers/optics/lens_fov.h"

#include <array>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace entoptic::drivers {

namespace vive_pro {

namespace {

constexpr int read_timeout_ms = 100;
constexpr int kept_by_kernel = 64;                      // HIDRAW_BUFFER_SIZE
constexpr DurationNs frozen_after = 500'000'000;   // 500 samples are missing
constexpr DurationNs reopen_after = 3 * ns_per_s;  // a device that froze is opened anew
constexpr DurationNs look_again_every = 500'000'000;
constexpr DurationNs complete_every = ns_per_s;  // look for functions that were not there when it was opened

}  // namespace

Device::Device(HidBus& bus, Clock& clock, Connection connection, ReportTap tap)
    : bus_(bus),
      clock_(clock),
      calibration_(connection.calibration),
      configuration_(connection.configuration),
      ranges_(connection.ranges),
      tap_(std::move(tap)),
      connection_(std::move(connection)),
      tracker_(calibration_, ranges_) {
    supervisor_ = std::thread([this] { supervise(); });
}

Device::~Device() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    reading_ = false;
    changed_.notify_all();
    supervisor_.join();
}

bool Device::wait(DurationNs duration) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::nanoseconds(duration), [this] { return stop_; });
    return !stop_;
}

// Reads while there is something to read; then looks for the same headset until it is back.
void Device::supervise() {
    for (;;) {
        run_connection();
        switch_off(connection_);
        connection_.imu.reset();
        connection_.light.reset();
        connection_.mainboard.reset();
        do {
            if (!wait(look_again_every)) return;
        } while (!reconnect());
    }
}

void Device::run_connection() {
    reading_ = true;
    {
        const std::lock_guard lock(mutex_);
        if (stop_) reading_ = false;
    }
    const TimeNs begun = clock_.now();
    std::array<std::thread, 3> readers;
    const auto read = [&](HidDevice* device, Source source) {
        std::thread& reader = readers[static_cast<std::size_t>(source)];
        if (device && !reader.joinable()) reader = std::thread([this, device, source] { read_loop(*device, source); });
    };
    const auto begin = [&] {
        if (const auto on = switch_on(connection_); !on)
            log::warn("The light receiver was not switched on, so there is no position: {}", on.error().message);
        read(connection_.imu.get(), Source::imu);
        read(connection_.light.get(), Source::light);
        read(connection_.mainboard.get(), Source::mainboard);
    };
    begin();
    TimeNs look_at = begun + complete_every;
    while (reading_ && wait(100'000'000)) {
        if (clock_.now() >= look_at) {
            if (complete(bus_, connection_)) begin();
            look_at = clock_.now() + complete_every;
        }
        const TimeNs silent = clock_.now() - std::max(begun, tracker_.statistics().newest_sample);
        if (silent > frozen_after)
            lost("it sends no motion samples any more", silent > reopen_after);
        else
            found();
    }
    reading_ = false;
    for (std::thread& reader : readers)
        if (reader.joinable()) reader.join();
}

void Device::read_loop(HidDevice& device, Source source) {
    std::array<std::uint8_t, 64> report{};
    // The kernel keeps the last 64 reports from when it was opened: old, and with a gap after them.
    for (int i = 0; i < kept_by_kernel; ++i)
        if (const auto old = device.read(report, 0); !old || *old == 0) break;
    while (reading_) {
        const auto got = device.read(report, read_timeout_ms);
        const TimeNs arrival = clock_.now();
        if (!got) {
            lost(got.error().message, true);
            return;
        }
        if (*got == 0) continue;
        const Bytes bytes(report.data(), *got);
        if (tap_) tap_(source, bytes, arrival);
        if (source == Source::imu)
            tracker_.imu_report(bytes, arrival);
        else if (source == Source::light)
            tracker_.light_report(bytes, arrival);
        else
            tracker_.mainboard_report(bytes, arrival);
    }
}

bool Device::reconnect() {
    for (const Functions& functions : find_headsets(bus_)) {
        if (!functions.imu.serial.empty() && functions.imu.serial != connection_.functions.imu.serial) continue;
        auto connection = connect(bus_, functions);
        if (!connection) {
            log::debug("{}", connection.error().message);
            continue;
        }
        if (connection->calibration.serial != calibration_.serial) continue;  // somebody else's lenses
        connection_ = std::move(*connection);
        ++reconnections_;
        log::info("The headset {} is back.", calibration_.serial);
        return true;
    }
    return false;
}

void Device::found() {
    const std::lock_guard lock(mutex_);
    if (reading_) present_ = true;   // else a reader has just said that it is gone
}

void Device::lost(const std::string& why, bool close) {
    const std::lock_guard lock(mutex_);
    if (!reading_) return;  // the first reason is the true one
    if (close) reading_ = false;
    if (present_) log::warn("The headset {} is absent: {}", calibration_.serial, why);
    present_ = false;
    why_ = why;
}

HeadsetStatus Device::status() const {
    const MainboardReading reading = tracker_.mainboard();
    HeadsetStatus out;
    {
        const std::lock_guard lock(mutex_);
        out.present = present_;
        if (!present_) out.why = why_;
    }
    if (reading.time != 0 && out.present) {
        out.system_button = reading.system_button;
        if (reading.ipd_mm > 0) out.ipd_mm = reading.ipd_mm;
    }
    return out;
}

bool Device::user_present() {
    const MainboardReading reading = tracker_.mainboard();
    return reading.time != 0 && reading.worn && status().present;
}

double Device::ipd_mm(DurationNs patience) const {
    for (const TimeNs end = clock_.now() + patience; clock_.now() < end;) {
        const MainboardReading reading = tracker_.mainboard();
        if (reading.time != 0 && reading.ipd_mm > 0) return reading.ipd_mm;
        if (reading.time != 0) break;
        clock_.sleep_until(clock_.now() + 10'000'000);
    }
    return calibration_.lens_separation_m * 1e3;
}

Result<std::unique_ptr<Device>> open_device(HidBus& bus, Clock& clock, ReportTap tap) {
    const auto found = find_headsets(bus);
    if (found.empty())
        return missing(
            "No Vive Pro was found: no USB device 28de:2300 (or 28de:2000). Plug in the link box and its power, and switch it on; "
            "`entoptic doctor` checks the rest.");
    Error last{ErrorKind::missing, ""};
    for (const Functions& functions : found) {
        auto connection = connect(bus, functions);
        if (connection) return std::make_unique<Device>(bus, clock, std::move(*connection), std::move(tap));
        last = connection.error();
    }
    return forward_error(last);
}

DisplayIdentity display_of(const Calibration& calibration) {
    DisplayIdentity display;
    const bool vive = calibration.panel_width == 1080;
    display.name = fmt::format("HTC {}", vive ? "Vive" : "Vive Pro");
    if (!calibration.serial.empty()) display.name += fmt::format(" ({})", calibration.serial);
    display.panel_width = calibration.panel_width;
    display.panel_height = calibration.panel_height;
    // 90.04 and 89.53 Hz: the modes' own rates (facts/devices.md 1.5).
    display.refresh_numerator = vive ? 8953 : 2251;
    display.refresh_denominator = vive ? 100 : 25;
    display.period = display.refresh_time(0, 1);
    display.vblank_to_photon = nanoseconds(calibration.vsync_to_photons_s + calibration.persistence_s / 2);
    display.photometry = {130, 0.04f};  // published for the Vive Pro (docs/sources.md), not measured on this one
    return display;
}

namespace {

struct OpenHeadset {
    std::shared_ptr<Device> device;
    AbsentEyes eyes{"the headset has no eye tracker of its own that Linux can read"};
};

}  // namespace

Headset headset_of(const std::shared_ptr<Device>& device, double ipd_mm) {
    auto open = std::make_shared<OpenHeadset>();
    open->device = device;
    Headset headset;
    headset.display = display_of(device->calibration());
    for (std::size_t side = 0; side < 2; ++side) {
        EyeOptics& optics = headset.eyes[side];
        optics.lens = device->calibration().lenses[side];
        optics.fov = lens_fov(optics.lens);
        optics.head_from_eye.position.x = static_cast<float>((side == 0 ? -0.5e-3 : 0.5e-3) * ipd_mm);
    }
    headset.head = &device->tracker();
    headset.eye_tracker = &open->eyes;
    headset.status = device.get();
    headset.presence = device.get();
    headset.owner = open;
    return headset;
}

}  // namespace vive_pro

namespace {

Result<Headset> open(const DriverOptions& options) {
    constexpr DurationNs first_mainboard_report = 300'000'000;  // they come every 52 ms
    static MonotonicClock monotonic;                            // a device's times are CLOCK_MONOTONIC's, whatever clock the session has
    ENTOPTIC_TRY(device, vive_pro::open_device(system_hid_bus(), monotonic));
    if (!options.real_time) return usage_error("A real headset runs in real time. Use --clock real.");
    const std::shared_ptr<vive_pro::Device> shared = std::move(device);
    return vive_pro::headset_of(shared, shared->ipd_mm(first_mainboard_report));
}

}  // namespace

const Driver vive_pro_driver{"vive-pro", "HTC Vive Pro or Vive over USB: motion, lighthouse position, proximity, lens distance", open};

}  // namespace entoptic::drivers
