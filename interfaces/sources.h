// What devices offer. Each is one small capability; a device is a named list of them. All calls are thread-safe and never
// block; times are the injected clock's. A source that lost its device answers with the documented fallback and says so.
#pragma once

#include "base/pose.h"
#include "base/time.h"
#include "interfaces/observer.h"

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <string>

namespace entoptic {

// A tracked pose with its first derivatives, in world coordinates: y up against gravity, origin on the floor, metres.
struct PoseState {
    Pose pose;
    glm::vec3 linear_velocity{0};     // m/s
    glm::vec3 angular_velocity{0};    // rad/s, world axes
    bool orientation_valid = false, position_valid = false;       // the numbers mean something
    bool orientation_tracked = false, position_tracked = false;   // and are measured now, not held or modelled
    bool velocity_valid = false;
};

class PoseSource {
public:
    virtual ~PoseSource() = default;
    // The pose at `time`: interpolated history in the past (at least 1 s back), prediction in the future.
    virtual PoseState pose_at(TimeNs time) = 0;
};

class EyeSource {
public:
    virtual ~EyeSource() = default;
    // Both eyes at `time` (usually the photon time of a frame), filtered and predicted. Always finite.
    virtual Observer observer_at(TimeNs time) = 0;
    // The newest raw sample of an eye (0 left, 1 right) that had arrived by `time`.
    virtual std::optional<RawEyeSample> raw_at(int eye, TimeNs time) = 0;
    virtual bool present() const = 0;             // false: never available; OpenXR reports no eye gaze support
    virtual std::string description() const = 0;  // for status: what it is, or why it is absent
};

// Whether somebody wears the headset, as its proximity sensor says.
class PresenceSource {
public:
    virtual ~PresenceSource() = default;
    virtual bool user_present() = 0;
};

// How a headset is.
struct HeadsetStatus {
    bool present = true;
    std::string why;                    // why it is absent, for people
    std::optional<double> ipd_mm;       // distance of its lenses now
    bool system_button = false;         // pressed
};

class StatusSource {
public:
    virtual ~StatusSource() = default;
    virtual HeadsetStatus status() const = 0;
};

// State of a simulated or real hand controller. Superset of what common interaction profiles carry.
struct ControllerState {
    PoseState grip, aim;              // world
    float trigger = 0, squeeze = 0;   // 0..1
    glm::vec2 thumbstick{0}, trackpad{0};   // -1..1
    bool thumbstick_click = false, thumbstick_touch = false, trackpad_click = false, trackpad_touch = false;
    bool trigger_touch = false;
    bool a_click = false, b_click = false, menu_click = false, system_click = false, select_click = false;
    bool active = false;
};

class ControllerSource {
public:
    virtual ~ControllerSource() = default;
    virtual ControllerState state_at(TimeNs time) = 0;
    // Vibrates from `time` on: amplitude 0..1, frequency in Hz (0 = the device's choice). Amplitude 0 stops.
    virtual void vibrate(TimeNs time, DurationNs duration, float frequency_hz, float amplitude) = 0;
};

}  // namespace entoptic
