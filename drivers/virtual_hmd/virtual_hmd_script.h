// What the wearer of the virtual headset does over time, and its text form. The format is described in virtual_hmd.md.
// Everything here is a pure function of (script, seed, time); time is nanoseconds since DriverOptions::start_time.
#pragma once

#include "base/result.h"
#include "base/time.h"
#include "drivers/virtual_hmd/virtual_hmd_channel.h"
#include "interfaces/sources.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace entoptic::drivers {

// Half-open, seconds of script time.
struct Interval {
    double start = 0, end = 0;
};

// The lid closes over 0.1 s from `start`, stays shut for `closed`, opens over 0.2 s (facts/perception.md 3.5).
struct Blink {
    double start = 0, closed = 0.05;  // s
    static constexpr double closing = 0.1, opening = 0.2;
    double end() const { return start + closing + closed + opening; }
};

enum class Button { thumbstick_click, thumbstick_touch, trackpad_click, trackpad_touch, trigger_touch, a, b, menu, system, select };
constexpr std::size_t button_count = 10;
const std::array<const char*, button_count>& button_names();

struct ControllerScript {
    bool enabled = true;
    Channel<3> position_m, orientation_deg;                   // grip in world; orientation: yaw right, pitch up, roll clockwise
    Channel<1> trigger, squeeze;                              // 0..1
    Channel<2> thumbstick, trackpad;                          // -1..1
    std::array<std::vector<Interval>, button_count> buttons;  // pressed
    std::vector<Interval> lost;                               // pose held, not tracked
    std::vector<Interval> off;                                // not active
};

// The simulated eye tracker. Defaults: virtual_hmd.md, with their sources.
struct TrackerScript {
    double rate_hz = 200;                // of each eye's camera
    double latency_ms = 10;              // from exposure to arrival
    double latency_jitter_ms = 2;        // uniform, either way
    double read_ahead_ms = 100.0 / 9;    // the compositor asks so long before the light of the frame
    double gaze_noise_deg = 0.2;         // standard deviation of each axis, white
    double gaze_offset_deg = 0.5;        // standard deviation of each axis's constant calibration error
    double gaze_drift_deg = 0.2;         // root mean square of each axis's slow drift (17 to 61 s)
    double pupil_noise_mm = 0.03;        // standard deviation, white
    double dropout_probability = 0.005;  // of a sample in which no pupil is found
    double bursts_per_minute = 2;        // of 20 to 120 ms in which no pupil is found
    double missing_probability = 0.002;  // of a sample that never arrives
};
// No noise, error, delay or dropout.
TrackerScript ideal_tracker(const TrackerScript& tracker);

struct Script {
    std::string name, description;
    double duration_s = 0;  // end of the last thing in it, unless given
    bool loop = false;

    Channel<3> head_position_m, head_orientation_deg;
    Channel<2> gaze_deg;                                    // right, up: from the point between the eyes
    Channel<1> vergence_dioptres;                           // 1 / distance of the fixated point
    std::optional<std::array<Channel<2>, 2>> eye_gaze_deg;  // instead of the two above
    std::optional<Channel<1>> pupil_mm;                     // none: the tracker sees no pupil diameter
    std::vector<Blink> blinks;
    double spontaneous_blinks_per_minute = 15;
    std::vector<Interval> head_lost, eyes_lost;
    TrackerScript tracker;
    std::array<ControllerScript, 2> controllers;

    // A standing person looking straight ahead; controllers at rest.
    Script();
    // Time inside the script, in seconds: from 0 to duration_s when it loops.
    double local_time(DurationNs elapsed) const;
};

// The interval that holds `time`, if any.
const Interval* interval_at(const std::vector<Interval>& intervals, double time);

// Orientation of yaw (right), pitch (up), roll (clockwise as the wearer sees it), in degrees, and its angular velocity in world axes.
glm::dquat orientation_of(const std::array<double, 3>& yaw_pitch_roll_deg);
glm::dvec3 angular_velocity_of(const ChannelValue<3>& yaw_pitch_roll_deg);

// Head pose with exact derivatives. While lost: the position is held and not tracked, the orientation goes on (as an IMU gives it).
PoseState head_at(const Script& script, DurationNs elapsed);
// Input and grip; aim points the same way from 5 cm ahead. While lost the pose is held and not tracked.
ControllerState controller_at(const Script& script, int hand, DurationNs elapsed);

// TOML text to a script. `source` names it in errors, which say the line. Unknown keys, wrong types, values outside their range,
// times that do not increase and saccades that overlap are errors (kind usage).
Result<Script> parse_script(const std::string& text, const std::string& source);

struct BuiltinScript {
    const char* name;
    const char* text;  // in the same format, so it is an example too
};
const std::vector<BuiltinScript>& builtin_scripts();

// A built-in script's name, or else a file's path (at most 16 MiB).
Result<Script> load_script(const std::string& name_or_path);

}  // namespace entoptic::drivers
