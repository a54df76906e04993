// The reader of recordings, and what replay makes of their samples.
#include "drivers/replay/replay_device.h"

#include <cstdlib>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>
#include <vector>
#include <zlib.h>

using namespace entoptic::drivers;

namespace {

// Without this no changed byte would come past the check sums.
std::vector<std::uint8_t> with_right_sums(const std::uint8_t* data, std::size_t size) {
    std::vector<std::uint8_t> out(data, data + size);
    constexpr std::size_t magic = 8, header = 16, sum = 4;
    for (std::size_t at = magic; at + header + sum <= out.size();) {
        const std::size_t length = out[at] | static_cast<std::size_t>(out[at + 1]) << 8 | static_cast<std::size_t>(out[at + 2]) << 16;
        out[at + 3] = 0;
        if (at + header + length + sum > out.size()) break;
        const auto right = static_cast<std::uint32_t>(crc32(0, &out[at], static_cast<uInt>(header + length)));
        for (std::size_t i = 0; i < sum; ++i) out[at + header + length + i] = static_cast<std::uint8_t>(right >> (8 * i));
        at += header + length + sum;
    }
    return out;
}

void run(const std::uint8_t* data, std::size_t size) {
    static const int file = memfd_create("recording", MFD_CLOEXEC);
    if (file < 0 || ftruncate(file, 0) != 0 || pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) std::abort();
    auto session = load_session(fmt::format("/proc/self/fd/{}", file));
    if (!session) return;
    const auto shared = std::make_shared<const RecordedSession>(std::move(*session));
    const auto headset = replay_headset(shared, shared->start);
    if (!headset) return;
    const entoptic::DurationNs length = shared->end - shared->start;
    for (int i = 0; i <= 4; ++i) {
        const entoptic::TimeNs time = shared->start + length / 4 * i;
        (void)headset->head->pose_at(time);
        const auto observer = headset->eye_tracker->observer_at(time);
        for (const auto& eye : observer.eyes)
            if (!(eye.pupil_diameter_mm >= 1) || !(eye.pupil_diameter_mm <= 10)) __builtin_trap();  // the filter promises 1.5 to 9
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    run(data, size);
    const auto repaired = with_right_sums(data, size);
    run(repaired.data(), repaired.size());
    return 0;
}
