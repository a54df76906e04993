// Gaze, pupil and blinks over time, from a CSV file with the columns time_s, gaze_x_deg, gaze_y_deg, pupil_mm, blink in any order, as an
// eye tracker or a person wrote it. Only time_s is required; lines that start with # are remarks. A gaze or pupil that is empty, "nan" or
// "n/a", or that no eye can have (pupil outside 1.5 to 9 mm, gaze beyond 180 degrees to a side or 90 up and down), is one that was not found.
// Between two rows that have them gaze and pupil are linear; a row's value holds up to a row without one, and the last row's for ever.
// A blink begins with the first row of 1 after one of 0: from then the lid closes, and from the next row of 0 it opens, each in its own
// time; what rows say of gaze and pupil while it is shut, or just before and after, counts as not found.
//
// TraceEye makes of it the eye that the models get, by the filters that a runtime's eye tracker goes through (drivers/eye_tracking).
#pragma once

#include "base/result.h"
#include "drivers/eye_tracking/gaze_track.h"
#include "drivers/eye_tracking/pupil_track.h"

#include <optional>
#include <string>
#include <vector>

namespace entoptic::app {

class Trace {
public:
    // Errors name the file and the line; a column in which no row has a value that an eye can have is one, too.
    static Result<Trace> read(const std::string& path);

    // What the rows say at a time; none: not found. Before the first row its values hold.
    std::optional<drivers::GazeAngles> gaze_at(double time_s) const;  // degrees from the centre, right and up positive
    std::optional<double> pupil_at(double time_s) const;              // mm
    double eyelid_open_at(double time_s) const;                       // 0 closed .. 1 open

    bool has_gaze() const { return has_gaze_; }  // there is a column of it
    bool has_pupil() const { return has_pupil_; }
    bool has_blinks() const;
    std::size_t rows() const { return rows_.size(); }
    std::size_t rows_without_gaze() const { return without_gaze_; }  // where there is a column of it
    std::size_t rows_without_pupil() const { return without_pupil_; }

    // How long a lid takes from open to closed and back, s. choice: within what is seen of spontaneous blinks, which close faster than they
    // open.
    static constexpr double closing_s = 0.1, opening_s = 0.2;

private:
    struct Row {
        double time_s = 0;
        std::optional<drivers::GazeAngles> gaze;
        std::optional<double> pupil_mm;
        bool blink = false;
    };
    template <class T> std::optional<T> value_at(double time_s, std::optional<T> Row::*value) const;
    void count();
    void leave_out_blinks();

    std::vector<Row> rows_;  // by time, never empty
    bool has_gaze_ = false, has_pupil_ = false;
    std::size_t without_gaze_ = 0, without_pupil_ = 0;
};

// The trace's eye as time goes on.
class TraceEye {
public:
    explicit TraceEye(Trace trace) : trace_(std::move(trace)), pupil_(drivers::PupilFilterParameters{}) {}

    // To `time_s`, which never goes back. `model_mm`: where the pupil relaxes to once it has not been found for half a second.
    void advance(double time_s, double model_mm);

    // Held over gaps of 0.15 s, then easing to `centre`; `centre` where the trace has none.
    drivers::GazeAngles gaze(drivers::GazeAngles centre) const;
    // Held over gaps of 0.5 s, then relaxing, low-passed, at most 6 mm/s narrower and 2 mm/s wider; none before the first.
    std::optional<double> pupil_mm() const { return pupil_.seen() ? std::optional(pupil_.diameter_mm()) : std::nullopt; }
    double eyelid_open() const { return trace_.eyelid_open_at(time_s_); }
    const Trace& trace() const { return trace_; }

private:
    void sample(double time_s);

    Trace trace_;
    drivers::GazeTrack gaze_;
    drivers::PupilTrack pupil_;
    drivers::PupilFilterParameters pupil_parameters_;
    double time_s_ = 0;
    std::int64_t samples_ = 0;
};

}  // namespace entoptic::app
