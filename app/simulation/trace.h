// Gaze, pupil and blinks over time, from a CSV file with the columns time_s, gaze_x_deg, gaze_y_deg, pupil_mm, blink in any order.
// Only time_s is required; lines that start with # are remarks. Between rows gaze and pupil are linear, blink holds. A blink begins with the
// first row of 1 after one of 0: from then the lid closes, and from the next row of 0 it opens, each in its own time.
#pragma once

#include "base/result.h"

#include <optional>
#include <string>
#include <vector>

namespace entoptic::app {

struct TraceState {
    double gaze_x_deg = 0, gaze_y_deg = 0;  // from the centre, right and up positive
    std::optional<double> pupil_mm;         // none: not in the trace
    bool blink = false;
    double eyelid_open = 1;                 // 0 closed .. 1 open
};

class Trace {
public:
    static Result<Trace> read(const std::string& path);
    // Before the first row its values hold, after the last row its.
    TraceState at(double time_s) const;
    double end_s() const { return rows_.back().time_s; }
    bool has_blinks() const;

    // How long a lid takes from open to closed and back, s. choice: within what is seen of spontaneous blinks, which close faster than they
    // open.
    static constexpr double closing_s = 0.1, opening_s = 0.2;

private:
    struct Row {
        double time_s = 0;
        TraceState state;
    };
    double eyelid_open_at(double time_s) const;

    std::vector<Row> rows_;  // by time, never empty
};

}  // namespace entoptic::app
