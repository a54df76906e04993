#include "drivers/fusion/device_clock.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace entoptic::drivers {

namespace {

constexpr double window_s = 0.5;
constexpr std::size_t kept_windows = 120;     // a minute: temperature moves crystals more slowly
constexpr std::size_t windows_for_slope = 8;  // below this the slope of jitter is worse than the crystals' own
constexpr double largest_slope = 200e-6;      // choice: twice what a cheap crystal has
constexpr double early_ns = 20e6;             // a sample cannot come before it was taken; drift alone is below 1 ms
constexpr double late_ns = 500e6;             // late by more for a second of samples: the counter was set back
constexpr int late_samples = 1000;

}  // namespace

DeviceClock::DeviceClock(double ticks_per_second) : ns_per_tick_(1e9 / ticks_per_second) {}

double DeviceClock::line_ns(double ticks) const { return nominal_ns(ticks) + offset_ns_ + slope_ * nominal_ns(ticks - pivot_); }

double DeviceClock::drift_ppm() const { return -slope_ / (1 + slope_) * 1e6; }

TimeNs DeviceClock::host_time(std::uint32_t ticks) const {
    return first_arrival_ + std::llround(line_ns(ticks_ + static_cast<std::int32_t>(ticks - last_ticks_)));
}

void DeviceClock::restart(std::uint32_t ticks, TimeNs arrival) {
    started_ = true;
    last_ticks_ = ticks;
    ticks_ = window_start_ = pivot_ = 0;
    first_arrival_ = arrival;
    anchors_.clear();
    window_ = {0, 0};
    offset_ns_ = 0;  // the slope stays: it is the crystal's
    late_ = 0;
}

TimeNs DeviceClock::sample(std::uint32_t ticks, TimeNs arrival) {
    if (!started_) restart(ticks, arrival);
    ticks_ += static_cast<std::int32_t>(ticks - last_ticks_);
    last_ticks_ = ticks;
    const double since_first = static_cast<double>(arrival - first_arrival_);
    const double lateness = since_first - line_ns(ticks_);
    late_ = lateness > late_ns ? late_ + 1 : 0;
    if (lateness < -early_ns || late_ > late_samples) {
        if (anchors_.size() > 1) ++jumps_;   // younger, it was a burst of old samples at the start
        restart(ticks, arrival);
    } else {
        const double excess = since_first - nominal_ns(ticks_);
        if (excess < window_.excess || ticks_ == window_start_) window_ = {ticks_, excess};
        if (anchors_.size() < windows_for_slope && lateness < 0) offset_ns_ += lateness;  // the line goes down at once while it is young
        if (nominal_ns(ticks_ - window_start_) > window_s * 1e9) close_window();
    }
    const TimeNs on_line = first_arrival_ + std::llround(line_ns(ticks_));
    last_time_ = std::max(std::min(on_line, arrival), last_time_ + 1);
    return last_time_;
}

// A new line: least squares through the windows' earliest arrivals, moved down until most of them lie on it or above.
void DeviceClock::close_window() {
    anchors_.push_back(window_);
    if (anchors_.size() > kept_windows) anchors_.pop_front();
    window_start_ = ticks_;
    window_ = {ticks_, 1e300};
    double mean_ticks = 0, mean_excess = 0;
    for (const Anchor& a : anchors_) mean_ticks += a.ticks, mean_excess += a.excess;
    mean_ticks /= static_cast<double>(anchors_.size());
    mean_excess /= static_cast<double>(anchors_.size());
    pivot_ = mean_ticks;
    if (anchors_.size() >= windows_for_slope) {
        double xx = 0, xy = 0;
        for (const Anchor& a : anchors_) {
            const double x = nominal_ns(a.ticks - mean_ticks);
            xx += x * x;
            xy += x * (a.excess - mean_excess);
        }
        slope_ = std::clamp(xy / xx, -largest_slope, largest_slope);
    }
    std::vector<double> residuals;
    for (const Anchor& a : anchors_) residuals.push_back(a.excess - slope_ * nominal_ns(a.ticks - pivot_));
    const auto low = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 10);
    std::nth_element(residuals.begin(), low, residuals.end());
    offset_ns_ = *low;
}

}  // namespace entoptic::drivers
