// Gaze, pupil and blinks over time, from a CSV file with the columns time_s, gaze_x_deg, gaze_y_deg, pupil_mm, blink in any order.
// Only time_s is required; lines that start with # are remarks. Between rows gaze and pupil are linear, blink holds.
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
};

class Trace {
public:
    static Result<Trace> read(const std::string& path);
    // Before the first row its values hold, after the last row its.
    TraceState at(double time_s) const;
    double end_s() const { return rows_.back().time_s; }

private:
    struct Row {
        double time_s = 0;
        TraceState state;
    };
    std::vector<Row> rows_;  // by time, never empty
};

}  // namespace entoptic::app
