// HTC Vive Pro (and Vive, Vive Pro Eye without its eye tracker) over USB: threads that read it, what it offers, and what happens when it
// is unplugged, plugged in again, or freezes. See vive_pro.md.
#pragma once

#include "drivers/driver.h"
#include "drivers/vive_pro/vive_pro_connection.h"
#include "drivers/vive_pro/vive_pro_tracker.h"

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace entoptic::drivers {

extern const Driver vive_pro_driver;

namespace vive_pro {

// Where a report came from; also the stream's number in recordings.
enum class Source : std::uint8_t { imu = 0, light = 1, mainboard = 2 };
// Sees every report before it is decoded, from the threads that read. Must not block.
using ReportTap = std::function<void(Source, Bytes, TimeNs arrival)>;

class Device final : public StatusSource, public PresenceSource {
public:
    // Takes over an open connection. `bus` and `clock` live longer.
    Device(HidBus& bus, Clock& clock, Connection connection, ReportTap tap = {});
    ~Device() override;
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    Tracker& tracker() { return tracker_; }
    const Calibration& calibration() const { return calibration_; }
    const ImuRanges& ranges() const { return ranges_; }
    const std::string& configuration() const { return configuration_; }
    HeadsetStatus status() const override;
    bool user_present() override;  // by the proximity sensor; false while the headset is absent
    std::uint64_t reconnections() const { return reconnections_; }

    // Lens distance as the mainboard says within `patience`, else the configuration's, mm.
    double ipd_mm(DurationNs patience) const;

private:
    void supervise();
    void run_connection();
    bool reconnect();
    void read_loop(HidDevice& device, Source source);
    void found();
    void lost(const std::string& why, bool close);
    bool wait(DurationNs duration);  // false: stop

    HidBus& bus_;
    Clock& clock_;
    const Calibration calibration_;
    const std::string configuration_;
    const ImuRanges ranges_;
    const ReportTap tap_;
    Connection connection_;
    Tracker tracker_;

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    bool stop_ = false;
    bool present_ = true;
    std::string why_;                    // why absent
    std::atomic<bool> reading_ = false;  // false: the readers end
    std::atomic<std::uint64_t> reconnections_ = 0;
    std::thread supervisor_;
};

// The first headset on the bus. Errors: missing (none is there, or it may not be opened), failed (it is there and does not answer).
Result<std::unique_ptr<Device>> open_device(HidBus& bus, Clock& clock, ReportTap tap = {});
// A Headset for it. `ipd_mm` between the eyes.
Headset headset_of(const std::shared_ptr<Device>& device, double ipd_mm);
// Display and optics as a calibration gives them.
DisplayIdentity display_of(const Calibration& calibration);

}  // namespace vive_pro
}  // namespace entoptic::drivers
