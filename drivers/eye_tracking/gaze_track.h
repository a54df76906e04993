// Where one eye points: smoothing that keeps saccades, and prediction. Fed with valid samples only. A plain value: copying it keeps
// the state as it was.
#pragma once

#include "base/time.h"
#include "drivers/eye_tracking/eye_filter_parameters.h"
#include "drivers/eye_tracking/gaze_angles.h"
#include "drivers/eye_tracking/recent_values.h"

namespace entoptic::drivers {

class GazeTrack {
public:
    // `time` of exposure, later than the last one; `angles` finite, degrees.
    void add(const GazeFilterParameters& parameters, TimeNs time, TimeNs arrival, GazeAngles angles);
    // Forgets what was estimated from samples later than `time` (they showed a closing lid).
    void roll_back(TimeNs time);

    bool seen() const { return seen_; }
    bool in_saccade() const { return saccade_; }
    GazeAngles estimate() const { return estimate_; }
    // The estimate carried to `time`, by at most max_prediction and max_prediction_deg.
    GazeAngles predicted(const GazeFilterParameters& parameters, TimeNs time) const;
    TimeNs sample_time() const { return sample_time_; }  // exposure and arrival of the newest sample used
    TimeNs sample_arrival() const { return sample_arrival_; }

private:
    void restart(GazeAngles angles, int samples);
    void smooth(const GazeFilterParameters& parameters, double dt, GazeAngles angles, double least_gain);
    bool follow(const GazeFilterParameters& parameters, double dt, GazeAngles angles);
    bool moved_twice(const GazeFilterParameters& parameters) const;
    double speed_deg_s() const;

    bool seen_ = false, saccade_ = false;
    GazeAngles estimate_{0}, velocity_{0};  // deg, deg/s
    GazeAngles last_used_{0};               // unfiltered
    double lag_s_ = 0;                      // delay of the low-pass at its present cut-off
    int samples_ = 0;                       // in the estimate since the last restart
    int outliers_ = 0;                      // samples left out in a row
    TimeNs sample_time_ = 0, sample_arrival_ = 0;
    RecentValues<GazeAngles, 4> raw_;
    RecentValues<GazeAngles, 16> estimates_;
};

}  // namespace entoptic::drivers
