// Session time to script time without overflow.
#pragma once

#include "base/time.h"

#include <algorithm>

namespace entoptic::drivers {

constexpr DurationNs longest_session = DurationNs{100} * 365 * 86400 * ns_per_s;

// `time` - `start`, kept within -1 s (before the start everything stands still) and 100 years.
constexpr DurationNs elapsed_since(TimeNs start, TimeNs time) {
    if (time <= start) return time < start ? std::max(time, start - ns_per_s) - start : 0;
    return std::min(time, start + longest_session) - start;
}

}  // namespace entoptic::drivers
