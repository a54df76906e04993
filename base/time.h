// Time is nanoseconds in a signed 64-bit integer (XrTime's own form), and is passed in: nothing below app/ reads a clock
// except through a Clock& that it was given.
#pragma once

#include <cstdint>

namespace entoptic {

using TimeNs = std::int64_t;      // a point in time; CLOCK_MONOTONIC in real time, the virtual clock in lockstep
using DurationNs = std::int64_t;  // a difference of two

constexpr DurationNs ns_per_s = 1'000'000'000;
constexpr double seconds(DurationNs duration) { return static_cast<double>(duration) * 1e-9; }
constexpr DurationNs nanoseconds(double s) { return static_cast<DurationNs>(s * 1e9); }

class Clock {
public:
    virtual ~Clock() = default;
    virtual TimeNs now() const = 0;
    // Returns when now() >= time. The lockstep clock jumps there at once.
    virtual void sleep_until(TimeNs time) = 0;
};

// CLOCK_MONOTONIC.
class MonotonicClock final : public Clock {
public:
    TimeNs now() const override;
    void sleep_until(TimeNs time) override;
};

// A clock that moves only when it is told to: the same run gives the same times.
// Thread-safe. now() never goes back.
class VirtualClock final : public Clock {
public:
    explicit VirtualClock(TimeNs start = ns_per_s) : now_(start) {}
    TimeNs now() const override;
    void sleep_until(TimeNs time) override { advance_to(time); }
    void advance_to(TimeNs time);

private:
    TimeNs now_;  // accessed atomically
};

}  // namespace entoptic
