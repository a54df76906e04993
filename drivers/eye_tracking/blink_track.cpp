#include "drivers/eye_tracking/blink_track.h"

#include <algorithm>

namespace entoptic::drivers {

bool BlinkTrack::add(const BlinkParameters& parameters, TimeNs time, TimeNs arrival, double confidence) {
    if (confidence >= parameters.confidence) {
        if (confirmed_) {
            ended_ = arrival;
            ended_exposure_ = time;
        }
        low_ = confirmed_ = false;
        return false;
    }
    if (!low_) {
        low_ = true;
        onset_ = time;
    }
    if (confirmed_ || time - onset_ <= parameters.confirm) return false;
    lid_at_detection_ = lid_open(parameters, arrival);
    confirmed_ = any_ = true;
    detected_ = arrival;
    return true;
}

bool BlinkTrack::usable(const BlinkParameters& parameters, TimeNs time) const {
    return !low_ && !(any_ && time - ended_exposure_ < parameters.margin);
}

TimeNs BlinkTrack::opening_start(const BlinkParameters& parameters) const {
    const TimeNs shut = detected_ + parameters.closing + parameters.closed;
    return std::max(shut, confirmed_ ? detected_ + parameters.longest : std::min(ended_, detected_ + parameters.longest));
}

TimeNs BlinkTrack::explained_until(const BlinkParameters& parameters) const {
    return confirmed_ ? detected_ + parameters.longest : std::min(ended_, detected_ + parameters.longest);
}

double BlinkTrack::lid_open(const BlinkParameters& parameters, TimeNs now) const {
    if (!any_) return 1;
    const TimeNs opening = opening_start(parameters);
    if (now < opening) return std::clamp(lid_at_detection_ - seconds(now - detected_) / seconds(parameters.closing), 0.0, 1.0);
    return std::clamp(seconds(now - opening) / seconds(parameters.opening), 0.0, 1.0);
}

}  // namespace entoptic::drivers
