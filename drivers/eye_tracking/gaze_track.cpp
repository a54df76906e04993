#include "drivers/eye_tracking/gaze_track.h"

#include <algorithm>
#include <cmath>

namespace entoptic::drivers {

namespace {

constexpr double two_pi = 6.283185307179586;

double low_pass_gain(double cutoff_hz, double dt) { return 1.0 / (1.0 + 1.0 / (two_pi * cutoff_hz * dt)); }

}  // namespace

void GazeTrack::restart(GazeAngles angles, int samples) {
    estimate_ = angles;
    velocity_ = {0, 0};
    lag_s_ = 0;
    samples_ = samples;
    outliers_ = 0;
}

// One Euro, but with the gain of a plain mean until that is smaller: after a saccade the estimate settles as fast as noise allows.
void GazeTrack::smooth(const GazeFilterParameters& parameters, double dt, GazeAngles angles, double least_gain) {
    velocity_ += low_pass_gain(parameters.derivative_cutoff_hz, dt) * ((angles - last_used_) / dt - velocity_);
    const double cutoff = parameters.min_cutoff_hz + parameters.beta_hz_per_deg_s * glm::length(velocity_);
    ++samples_;
    estimate_ += std::max({low_pass_gain(cutoff, dt), 1.0 / samples_, least_gain}) * (angles - estimate_);
    lag_s_ = 1.0 / (two_pi * cutoff);
    outliers_ = 0;
}

bool GazeTrack::moved_twice(const GazeFilterParameters& parameters) const {
    if (raw_.size() < 2) return false;
    const GazeAngles now = raw_.newest(0).value - estimate_, before = raw_.newest(1).value - estimate_;
    return glm::length(now) > parameters.saccade_onset_deg && glm::length(before) > parameters.saccade_onset_deg &&
           glm::dot(now, before) > 0;
}

// Mean of the last two samples against the mean of the two before.
double GazeTrack::speed_deg_s() const {
    if (raw_.size() < 4) return 0;
    const GazeAngles change = 0.5 * (raw_.newest(0).value + raw_.newest(1).value - raw_.newest(2).value - raw_.newest(3).value);
    const double apart = 0.5 * (seconds(raw_.newest(0).time - raw_.newest(2).time) + seconds(raw_.newest(1).time - raw_.newest(3).time));
    return glm::length(change) / apart;
}

// `dt` since the last sample used; this one is already in raw_. False when it is left out as an outlier.
bool GazeTrack::follow(const GazeFilterParameters& parameters, double dt, GazeAngles angles) {
    if (saccade_) {
        saccade_ = speed_deg_s() >= parameters.saccade_speed_deg_s;
        if (saccade_)
            restart(angles, 0);
        else
            restart(0.5 * (raw_.newest(0).value + raw_.newest(1).value), 2);
        return true;
    }
    const bool moved = moved_twice(parameters);
    if ((moved && speed_deg_s() >= parameters.saccade_speed_deg_s) || outliers_ >= 3) {
        saccade_ = true;
        restart(angles, 0);
    } else if (!moved && glm::length(angles - estimate_) > parameters.saccade_onset_deg) {
        ++outliers_;
        return false;
    } else {
        smooth(parameters, dt, angles, moved ? parameters.catch_up_gain : 0);
    }
    return true;
}

void GazeTrack::add(const GazeFilterParameters& parameters, TimeNs time, TimeNs arrival, GazeAngles angles) {
    const bool anew = !seen_ || time - sample_time_ > parameters.restart_gap;
    if (anew) raw_.clear();
    raw_.add(time, angles);
    if (anew) {
        saccade_ = false;
        restart(angles, 1);
    } else if (!follow(parameters, seconds(time - sample_time_), angles)) {
        return;
    }
    seen_ = true;
    last_used_ = angles;
    sample_time_ = time;
    sample_arrival_ = arrival;
    estimates_.add(time, estimate_);
}

void GazeTrack::roll_back(TimeNs time) {
    if (const auto* entry = estimates_.newest_until(time)) restart(entry->value, 0);
    saccade_ = false;
}

GazeAngles GazeTrack::predicted(const GazeFilterParameters& parameters, TimeNs time) const {
    const double speed = glm::length(velocity_);
    if (saccade_ || time <= sample_time_ || speed <= parameters.prediction_deadband_deg_s) return estimate_;
    const double ahead = seconds(std::min(time - sample_time_, parameters.max_prediction)) + lag_s_;
    const double lead = std::min((speed - parameters.prediction_deadband_deg_s) * ahead, parameters.max_prediction_deg);
    return estimate_ + velocity_ * (lead / speed);
}

}  // namespace entoptic::drivers
