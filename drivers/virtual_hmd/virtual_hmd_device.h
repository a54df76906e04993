// A Vive Pro without hardware: its display, its optics, and a wearer who follows a script. See virtual_hmd.md.
#pragma once

#include "drivers/driver.h"
#include "drivers/virtual_hmd/virtual_hmd_eyes.h"
#include "drivers/virtual_hmd/virtual_hmd_script.h"

#include <memory>
#include <mutex>
#include <vector>

namespace entoptic::drivers {

extern const Driver virtual_hmd_driver;

class VirtualHead final : public PoseSource {
public:
    VirtualHead(const Script& script, TimeNs start_time) : script_(script), start_time_(start_time) {}
    // Exact at any time.
    PoseState pose_at(TimeNs time) override;

private:
    const Script& script_;
    TimeNs start_time_;
};

// One call of vibrate().
struct HapticEvent {
    TimeNs time = 0;
    DurationNs duration = 0;
    float frequency_hz = 0, amplitude = 0;
};

class VirtualController final : public ControllerSource {
public:
    VirtualController(const Script& script, TimeNs start_time, int hand) : script_(script), start_time_(start_time), hand_(hand) {}
    // Exact at any time.
    ControllerState state_at(TimeNs time) override;
    void vibrate(TimeNs time, DurationNs duration, float frequency_hz, float amplitude) override;
    // The last 1024 vibrations, oldest first, for tests and for whoever wants to show them.
    std::vector<HapticEvent> haptic_events() const;

private:
    const Script& script_;
    TimeNs start_time_;
    int hand_;
    mutable std::mutex mutex_;
    std::vector<HapticEvent> events_;
};

// Everything behind the Headset; Headset::owner points to it.
// The virtual wearer never takes the headset off.
class VirtualPresence final : public PresenceSource {
public:
    bool user_present() override { return true; }
};

class VirtualHmd {
public:
    VirtualHmd(const DriverOptions& options, Script script);
    VirtualHmd(const VirtualHmd&) = delete;
    VirtualHmd& operator=(const VirtualHmd&) = delete;

    const Script& script() const { return script_; }
    const VirtualEyes& eyes() const { return eyes_; }
    VirtualHead& head() { return head_; }
    VirtualEyeTracker& eye_tracker() { return eye_tracker_; }
    PresenceSource& presence() { return presence_; }
    VirtualController& controller(int hand) { return hand == 0 ? left_ : right_; }

private:
    const Script script_;
    VirtualHead head_;
    VirtualEyes eyes_;
    VirtualEyeTracker eye_tracker_;
    VirtualPresence presence_;
    VirtualController left_, right_;
};

// The lens of Valve's form with the example coefficients for a Vive Pro (facts/devices.md 1.4).
Lens virtual_lens(int eye);
DisplayIdentity virtual_display(int panel_width, int panel_height);

// Errors (usage): sizes outside 16..8192, IPD outside 50..80 mm, a script that is not there or is wrong.
Result<std::shared_ptr<VirtualHmd>> make_virtual_hmd(const DriverOptions& options);
Headset headset_of(const std::shared_ptr<VirtualHmd>& hmd, const DriverOptions& options);

}  // namespace entoptic::drivers
