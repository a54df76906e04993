// Every number of the filter between an eye tracker and the compositor. Defaults are facts/perception.md 3.1 and 3.5 and
// facts/devices.md 4.7 unless a line says otherwise.
#pragma once

#include "base/pose.h"
#include "base/time.h"

#include <array>

namespace entoptic::drivers {

constexpr DurationNs milliseconds(int ms) { return DurationNs{ms} * 1'000'000; }

struct GazeFilterParameters {
    double min_cutoff_hz = 1.5;                 // One Euro (Casiez, Roussel, Vogel 2012), on degrees: cut-off at rest ...
    double beta_hz_per_deg_s = 0.3;             // ... and its growth with speed
    double derivative_cutoff_hz = 2.0;          // of the speed itself (1 Hz, Casiez's, lets a pursuit run ahead by a degree)
    double saccade_onset_deg = 0.75;            // two samples in a row that far off the estimate, to the same side: the eye has moved,
    double saccade_speed_deg_s = 50;            // in a saccade while it is faster than this over four samples (then nothing is smoothed),
    double catch_up_gain = 0.3;                 // else in a pursuit, which is caught up with at least this gain
    DurationNs restart_gap = milliseconds(50);  // no valid sample for longer: the next one is taken as it is
    DurationNs max_prediction = milliseconds(50);   // farthest extrapolation past the newest sample
    double max_prediction_deg = 2;                  // and how far it may lead
    double prediction_deadband_deg_s = 5;           // slower movements are not extrapolated
    DurationNs hold = milliseconds(150);            // without a valid sample the gaze is held so long ...
    double ease_tau_s = 0.3;                        // ... then eases to the other eye's gaze, if that is seen, else to the view's centre
    double vergence_tau_s = 0.2;                    // low-pass of the difference between the eyes that this uses, taken
    DurationNs vergence_window = milliseconds(10);  // from samples of both so close in time
};

struct PupilFilterParameters {
    double min_mm = 1.5, max_mm = 9;  // outside: not a pupil
    double low_pass_s = 0.1;
    double constriction_mm_s = 6, dilation_mm_s = 2;  // limits of speed; only the very first measurement may jump
    DurationNs fresh = milliseconds(20);              // an eye counts as measured so long after a valid sample
    DurationNs hold = milliseconds(500);              // without a valid sample the diameter is held so long (blinks last 0.3-0.4 s) ...
    double relax_tau_s = 1;                           // ... then relaxes to model_mm
    double model_mm = 4;  // the compositor replaces a diameter that says `modelled` by its own light-driven model
};

struct BlinkParameters {
    double confidence = 0.5;  // below for longer than `confirm`: a blink
    DurationNs confirm = milliseconds(40);
    DurationNs margin = milliseconds(30);     // samples before and after a blink that are not used
    DurationNs longest = milliseconds(1000);  // after that it is not a blink but a lost eye, and the lid opens
    DurationNs closing = milliseconds(100), closed = milliseconds(50), opening = milliseconds(200);  // the lid's course
};

struct EyeFilterParameters {
    double min_confidence = 0.6;
    GazeFilterParameters gaze;
    PupilFilterParameters pupil;
    BlinkParameters blink;
    std::array<Fov, 2> gaze_limits{Fov{-0.96f, 0.96f, 0.96f, -0.96f}, Fov{-0.96f, 0.96f, 0.96f, -0.96f}};  // gaze is clamped to these (rad)
    DurationNs silent = milliseconds(1000);   // no sample at all for longer: the tracker is absent
    DurationNs history = milliseconds(2000);  // times so long before the newest sample can still be asked for
};

}  // namespace entoptic::drivers
