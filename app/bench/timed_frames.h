// Which frames of a measurement count.
#pragma once

#include "app/bench/effect_rows.h"

#include <chrono>
#include <utility>

namespace entoptic::app {

// Shows frames 0, 1, 2 … by `show`, which gives each one's milliseconds, and takes the times from the third on (pipelines are compiled at their first
// dispatch): at most `frames` of them, and no more once there are three and `seconds` have gone by. Errors: those of `show`.
template <class Show> Result<Percentiles> timed_frames(int frames, double seconds, Show show) {
    constexpr int warm_up = 2, least = 3;
    std::vector<double> times;
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < frames + warm_up; ++i) {
        const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
        if (int(times.size()) >= least && spent.count() > seconds) break;
        Result<double> ms = show(static_cast<std::uint64_t>(i));
        if (!ms) return forward_error(ms.error());
        if (i >= warm_up) times.push_back(*ms);
    }
    return percentiles(std::move(times));
}

}  // namespace entoptic::app
