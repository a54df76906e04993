// From the raw samples of any eye tracker to an Observer the compositor can trust: always finite, inside its ranges, never faster than
// an eye, and honest about what is measured. A deterministic function of the samples, in the order of their arrival: how often and in
// which order it is asked changes nothing. Thread-safe.
//
// What it does to a sample: facts/perception.md 3.1c and 3.5, facts/devices.md 4.7; the numbers are in eye_filter_parameters.h.
#pragma once

#include "base/time.h"
#include "drivers/eye_tracking/blink_track.h"
#include "drivers/eye_tracking/eye_filter_parameters.h"
#include "drivers/eye_tracking/gaze_track.h"
#include "drivers/eye_tracking/pupil_track.h"
#include "interfaces/observer.h"

#include <array>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

namespace entoptic::drivers {

class EyeFilter {
public:
    explicit EyeFilter(const EyeFilterParameters& parameters = {});

    // A sample of eye 0 (left) or 1 (right) as the tracker gave it; its numbers may be anything. `arrival` is the driver's own and is
    // trusted: it never goes back, over both eyes. Samples that break this, or are not newer than the eye's last, are left out.
    void add(int eye, const RawEyeSample& sample);

    // Both eyes at `time`, from the samples that had arrived by `known_until`. Times further back than the history use its oldest
    // state. Gaze is predicted to `time`; pupil and lid are those of `known_until` (neither moves far in a frame).
    Observer observer_at(TimeNs known_until, TimeNs time) const;

    // The newest sample of an eye that had arrived by `time`, unfiltered.
    std::optional<RawEyeSample> raw_at(int eye, TimeNs time) const;

    // "left: tracked, right: no pupil found for 1.2 s"
    std::string status(TimeNs known_until) const;

    // Forgets everything.
    void reset();

    const EyeFilterParameters& parameters() const { return parameters_; }

private:
    struct Eye {
        GazeTrack gaze;
        BlinkTrack blink;
        bool sampled = false;
        TimeNs newest_time = 0, newest_arrival = 0;  // of any sample, valid or not
        TimeNs pupil_arrival = 0;                    // of the newest valid pupil
        bool pupil_seen = false;
        double confidence = 0;  // of the newest sample
    };
    struct State {
        explicit State(const EyeFilterParameters& parameters) : pupil(parameters.pupil) {}
        TimeNs arrival = 0;  // of the newest sample in it
        std::array<Eye, 2> eyes;
        PupilTrack pupil;
        bool vergence_known = false;
        GazeAngles vergence{0};  // left minus right, deg
    };
    struct RawEntry {
        int eye;
        RawEyeSample sample;
    };

    bool acceptable(int eye, const RawEyeSample& sample) const;
    void update(State& state, int eye, const RawEyeSample& sample) const;
    void update_vergence(State& state, int eye, const RawEyeSample& sample, double dt) const;
    State state_at(TimeNs known_until) const;
    bool gaze_fresh(const Eye& eye, TimeNs now) const;
    double gaze_share(const Eye& eye, TimeNs now) const;
    std::array<GazeAngles, 2> gaze_of(const State& state, TimeNs now, TimeNs time) const;
    EyeState eye_state(const State& state, int eye, GazeAngles gaze, TimeNs now) const;
    std::string eye_status(const State& state, int eye, TimeNs now) const;

    const EyeFilterParameters parameters_;
    mutable std::mutex mutex_;
    State latest_;
    std::deque<State> history_;  // the state after each sample, oldest first
    std::deque<RawEntry> raw_;   // the samples of that time
    bool forgotten_ = false;     // history_ no longer begins with the first sample
};

}  // namespace entoptic::drivers
