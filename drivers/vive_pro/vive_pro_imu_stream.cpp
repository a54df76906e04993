#include "drivers/vive_pro/vive_pro_imu_stream.h"

#include <algorithm>
#include <cmath>

namespace entoptic::drivers::vive_pro {

namespace {

constexpr double ticks_per_sample = ticks_per_second / 1000;
// The sequence number tells gaps of up to 127 samples; above that the clock does, up to where a jump of the clock is more likely.
constexpr std::int32_t sequence_tells_ticks = 120 * 48'000;
constexpr std::int32_t jump_ticks = 10 * 48'000'000;

std::int32_t ticks_after(const ImuSample& a, const ImuSample& b) { return static_cast<std::int32_t>(a.ticks - b.ticks); }
unsigned steps_after(const ImuSample& a, const ImuSample& b) { return static_cast<std::uint8_t>(a.sequence - b.sequence); }

ImuReport in_order_after(ImuReport report, const ImuSample& last) {
    std::sort(report.begin(), report.end(), [&](const ImuSample& a, const ImuSample& b) {
        return static_cast<std::int8_t>(steps_after(a, last)) < static_cast<std::int8_t>(steps_after(b, last));
    });
    return report;
}

}  // namespace

NewSamples ImuStream::take(const ImuReport& report) {
    NewSamples out;
    if (!started_) {
        restart(report, out);
        return out;
    }
    std::int32_t newest = ticks_after(report[0], last_), oldest = newest;
    for (const ImuSample& sample : report) {
        newest = std::max(newest, ticks_after(sample, last_));
        oldest = std::min(oldest, ticks_after(sample, last_));
    }
    if (newest > jump_ticks || oldest < -jump_ticks) {
        ++restarts_;
        restart(report, out);
    } else if (newest > sequence_tells_ticks) {
        const auto before = received_;
        const ImuSample last = last_;
        restart(report, out);
        const double missing = std::round(ticks_after(out.samples[0], last) / ticks_per_sample) - 1;
        lost_ += static_cast<std::uint64_t>(std::max(0.0, missing));
        ++gaps_;
        received_ = before + out.count;
    } else {
        for (const ImuSample& sample : in_order_after(report, last_)) accept(sample, out);
    }
    return out;
}

void ImuStream::accept(const ImuSample& sample, NewSamples& out) {
    const unsigned steps = steps_after(sample, last_);
    if (steps < 1 || steps > 127 || ticks_after(sample, last_) <= 0) return;
    if (steps > 1) {
        lost_ += steps - 1;
        ++gaps_;
    }
    last_ = sample;
    ++received_;
    out.samples[out.count++] = sample;
}

// All three, by their own times: what came before says nothing about them.
void ImuStream::restart(const ImuReport& report, NewSamples& out) {
    ImuReport sorted = report;
    std::sort(sorted.begin(), sorted.end(), [&](const ImuSample& a, const ImuSample& b) { return ticks_after(a, report[0]) < ticks_after(b, report[0]); });
    started_ = true;
    for (const ImuSample& sample : sorted) {
        if (out.count > 0 && ticks_after(sample, last_) <= 0) continue;
        last_ = sample;
        ++received_;
        out.samples[out.count++] = sample;
    }
}

}  // namespace entoptic::drivers::vive_pro
