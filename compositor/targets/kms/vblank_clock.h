// The display's own clock: when its refreshes are, from the kernel's stamps of them. Pure: no clock, no lock.
#pragma once

#include "compositor/targets/kms/drm_card.h"

#include <cstdint>
#include <deque>

namespace entoptic::compositor::kms {

// A straight line through the newest stamps (least squares over sequence and time): period and phase are better than a single stamp's
// microsecond, and a stamp that cannot be true is replaced by what the line says.
class VblankClock {
public:
    // `nominal_period` is the mode's own, pixel clock over total pixels: the period until enough was measured.
    explicit VblankClock(double nominal_period_ns) : nominal_period_ns_(nominal_period_ns), period_ns_(nominal_period_ns) {}

    struct Refresh {
        TimeNs time = 0;          // its first line, CLOCK_MONOTONIC; 0: the driver does not count refreshes
        std::int64_t passed = 0;  // refreshes since the one before; 0: there was none
        bool believed = true;     // false: `time` is the line's, as the stamp went back or lies off by over a quarter period
    };
    Refresh add(const Vblank& vblank);

    DurationNs period() const { return static_cast<DurationNs>(period_ns_ + 0.5); }
    std::uint64_t disbelieved() const { return disbelieved_; }

private:
    struct Stamp {
        std::int64_t sequence = 0;
        TimeNs time = 0;
    };
    void fit();
    double expected(std::int64_t sequence) const;

    double nominal_period_ns_, period_ns_;
    double phase_ns_ = 0;  // of the newest stamp's refresh, less its stamp
    std::deque<Stamp> stamps_;
    Stamp last_;  // newest refresh as answered
    bool any_ = false;
    int disbelieved_in_a_row_ = 0;
    std::uint64_t disbelieved_ = 0;
};

}  // namespace entoptic::compositor::kms
