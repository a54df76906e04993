// For the device tests: waiting, and what the test's own process holds.
#pragma once

#include <chrono>
#include <filesystem>
#include <malloc.h>
#include <thread>

namespace entoptic::devices {

inline void sleep_s(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

// Looks every `step_s` seconds; what it was in the end.
template <class Condition> bool within(double seconds, Condition condition, double step_s = 0.01) {
    for (double passed = 0; passed < seconds; passed += step_s) {
        if (condition()) return true;
        sleep_s(step_s);
    }
    return condition();
}

inline std::size_t entries_of(const char* folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}
inline std::size_t open_files() { return entries_of("/proc/self/fd"); }
inline std::size_t threads() { return entries_of("/proc/self/task"); }

// Bytes of the heap in use, over all threads.
inline std::size_t heap_in_use() {
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

}  // namespace entoptic::devices
