// The pupil both eyes share (the reflex is consensual), as a continuous function of time: held, relaxed, low-passed and never faster
// than a pupil can be. A plain value.
#pragma once

#include "base/time.h"
#include "drivers/eye_tracking/eye_filter_parameters.h"
#include "drivers/eye_tracking/recent_values.h"

#include <algorithm>
#include <array>

namespace entoptic::drivers {

class PupilTrack {
public:
    explicit PupilTrack(const PupilFilterParameters& parameters) : diameter_mm_(parameters.model_mm), target_mm_(parameters.model_mm) {}

    // Lets time pass to `time` (of arrival); times in the past change nothing. Work is bounded.
    void advance(const PupilFilterParameters& parameters, TimeNs time);
    // A diameter within the parameters' range that arrived at the present time.
    void add(const PupilFilterParameters& parameters, int eye, double diameter_mm);
    // Holds what was known at `time` instead of what came after (a closing lid).
    void roll_back(TimeNs time);

    bool seen() const { return seen_; }
    double diameter_mm() const { return diameter_mm_; }
    // A valid sample arrived at most hold ago.
    bool measured(const PupilFilterParameters& parameters) const { return seen_ && time_ - newest_arrival() <= parameters.hold; }
    TimeNs newest_arrival() const { return std::max(arrival_[0], arrival_[1]); }

private:
    void step(const PupilFilterParameters& parameters, DurationNs duration);

    bool seen_ = false, holding_ = false;
    TimeNs time_ = 0;
    double diameter_mm_, target_mm_;
    std::array<bool, 2> known_{};
    std::array<TimeNs, 2> arrival_{};
    std::array<double, 2> measured_mm_{};
    RecentValues<double, 16> before_;
};

}  // namespace entoptic::drivers
