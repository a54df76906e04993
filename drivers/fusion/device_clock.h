// A device's free-running counter to the host's monotonic time. Arrival times are late by a jitter of milliseconds that is never negative,
// so the line lies under them: the earliest arrival of every half second carries it, and its slope is the drift of the two clocks.
#pragma once

#include "base/time.h"

#include <cstdint>
#include <deque>

namespace entoptic::drivers {

class DeviceClock {
public:
    explicit DeviceClock(double ticks_per_second);

    // A sample with the device's time `ticks` (a counter of 32 bits that wraps) that arrived at `arrival`. Returns when it was taken, in
    // the host's time: never after `arrival`, and later than what was returned for an earlier sample.
    TimeNs sample(std::uint32_t ticks, TimeNs arrival);
    // The host's time of another stamp of the same counter, within 44 s of the last sample. Only after a first sample().
    TimeNs host_time(std::uint32_t ticks) const;

    bool started() const { return started_; }
    double drift_ppm() const;  // how much faster the device's second is than the host's, as measured; 0 until it is known
    std::uint64_t jumps() const { return jumps_; }  // the counter did not go on where it was: the line began anew

private:
    struct Anchor {
        double ticks = 0;   // since the beginning
        double excess = 0;  // arrival minus nominal time, ns; the smallest of its window
    };
    void restart(std::uint32_t ticks, TimeNs arrival);
    void close_window();
    double nominal_ns(double ticks) const { return ticks * ns_per_tick_; }
    double line_ns(double ticks) const;  // host time since first_arrival_

    const double ns_per_tick_;
    bool started_ = false;
    std::uint32_t last_ticks_ = 0;
    double ticks_ = 0;  // since the beginning, of the last sample
    TimeNs first_arrival_ = 0, last_time_ = 0;
    std::deque<Anchor> anchors_;
    Anchor window_;                     // of the window that is open
    double window_start_ = 0;           // ticks
    double offset_ns_ = 0, slope_ = 0;  // excess of the line at pivot_, and its change per nominal nanosecond
    double pivot_ = 0;                  // ticks
    int late_ = 0;                      // samples in a row that came far too late
    std::uint64_t jumps_ = 0;
};

}  // namespace entoptic::drivers
