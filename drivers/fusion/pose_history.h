// The last poses of a tracked head: interpolation between them, prediction after the newest. Thread-safe; locks are held for a look-up.
#pragma once

#include "base/time.h"
#include "interfaces/sources.h"

#include <mutex>
#include <vector>

namespace entoptic::drivers {

class PoseHistory {
public:
    // Keeps the last `capacity` poses: at 1000 a second the default is two seconds.
    explicit PoseHistory(std::size_t capacity = 2048);

    // Times must rise; one that does not is left out.
    void push(TimeNs time, const PoseState& state);
    // Interpolated within the history, its oldest before it. After the newest: turned on with the angular velocity and, where the position is
    // tracked, moved on with the linear velocity, for at most `max_prediction`; then it holds. Tracked flags are false more than
    // `stale_after` past the newest: nobody has measured since. Identity, not valid, before the first push.
    PoseState at(TimeNs time) const;

    static constexpr DurationNs max_prediction = 100'000'000;  // choice: longer is guesswork, and applications ask for no more
    static constexpr DurationNs stale_after = 150'000'000;     // choice: prediction over the photon time plus a stumble of the bus

private:
    struct Entry {
        TimeNs time = 0;
        PoseState state;
    };
    const Entry& entry(std::size_t index) const { return ring_[(first_ + index) % ring_.size()]; }

    mutable std::mutex mutex_;
    std::vector<Entry> ring_;
    std::size_t first_ = 0, count_ = 0;
};

// `state` as it is expected to be `seconds` later, with constant velocities.
PoseState predicted(const PoseState& state, double seconds);

}  // namespace entoptic::drivers
