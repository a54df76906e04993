// The last N values of something with their times, oldest overwritten first. No allocation; copyable with the filter's state.
#pragma once

#include "base/time.h"

#include <array>
#include <cstddef>

namespace entoptic::drivers {

template <class T, std::size_t N> class RecentValues {
public:
    struct Entry {
        TimeNs time = 0;
        T value{};
    };

    void add(TimeNs time, const T& value) {
        entries_[next_] = {time, value};
        next_ = (next_ + 1) % N;
        if (count_ < N) ++count_;
    }
    void clear() { count_ = 0; }
    std::size_t size() const { return count_; }
    // 0 is the newest; `back` < size().
    const Entry& newest(std::size_t back = 0) const { return entries_[(next_ + N - 1 - back) % N]; }
    // The newest entry not after `time`; else the oldest; null when empty.
    const Entry* newest_until(TimeNs time) const {
        for (std::size_t back = 0; back < count_; ++back) {
            if (newest(back).time <= time) return &newest(back);
        }
        return count_ ? &newest(count_ - 1) : nullptr;
    }

private:
    std::array<Entry, N> entries_{};
    std::size_t next_ = 0, count_ = 0;
};

}  // namespace entoptic::drivers
