#include "base/time.h"

#include <atomic>
#include <cerrno>
#include <ctime>

namespace entoptic {

TimeNs MonotonicClock::now() const {
    timespec ts{};
    clock_gettime(CLOCK_MONOTONIC, &ts);
    return static_cast<TimeNs>(ts.tv_sec) * ns_per_s + ts.tv_nsec;
}

void MonotonicClock::sleep_until(TimeNs time) {
    const timespec ts{time / ns_per_s, time % ns_per_s};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &ts, nullptr) == EINTR) {
    }
}

TimeNs VirtualClock::now() const { return std::atomic_ref(const_cast<TimeNs&>(now_)).load(); }

void VirtualClock::advance_to(TimeNs time) {
    std::atomic_ref now(now_);
    TimeNs current = now.load();
    while (current < time && !now.compare_exchange_weak(current, time)) {
    }
}

}  // namespace entoptic
