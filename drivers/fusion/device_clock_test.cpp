// labels: unit
#include "drivers/fusion/device_clock.h"

#include "base/noise.h"
#include "base/testing/ledger.h"

#include <cmath>
#include <gtest/gtest.h>

namespace entoptic::drivers {
namespace {

constexpr double rate = 48e6;

std::string fmt_ppm(double ppm) { return std::to_string(static_cast<int>(ppm)) + " ppm"; }

// A device whose clock runs `ppm` fast, read over a bus whose delays are as recorded: 1.2 ms in the median, 3.3 at most (facts 1.2).
struct Bus {
    double ppm = 0;
    std::uint32_t start_ticks = 0;
    TimeNs start = 5 * ns_per_s;
    std::uint32_t ticks(double t) const {
        return start_ticks + static_cast<std::uint32_t>(static_cast<std::uint64_t>(std::llround(t * rate * (1 + ppm * 1e-6))));
    }
    TimeNs arrival(double t, std::uint64_t n) const {
        const double delay = std::min(3.3e-3, 0.2e-3 - 1.2e-3 * std::log(1 - uniform01(7, n)));
        return start + nanoseconds(t + delay);
    }
};

double worst_after(const Bus& bus, double settle, double length, DeviceClock& clock) {
    double worst = 0;
    for (std::uint64_t n = 0; n < static_cast<std::uint64_t>(length * 1000); ++n) {
        const double t = static_cast<double>(n) * 1e-3;
        const TimeNs time = clock.sample(bus.ticks(t), bus.arrival(t, n));
        EXPECT_LE(time, bus.arrival(t, n) + 1);
        if (t > settle) worst = std::max(worst, std::abs(seconds(time - bus.start) - t - 0.2e-3));
    }
    return worst;
}

TEST(DeviceClock, FindsTheLineUnderTheJitterAndItsDrift) {
    for (const double ppm : {-30.0, 0.0, 30.0, 100.0}) {
        const Bus bus{ppm, 0xfff00000u};  // wraps at once, and again after 89 s
        DeviceClock clock(rate);
        const double worst = worst_after(bus, 10, 120, clock);
        EXPECT_LT(worst, 0.1e-3) << ppm;
        EXPECT_NEAR(clock.drift_ppm(), ppm, 1) << ppm;
        EXPECT_EQ(clock.jumps(), 0u);
        entoptic::testing::ledger("drivers.device_clock", fmt_ppm(ppm), "worst error ms from 10 s on", worst * 1e3);
    }
}

TEST(DeviceClock, IsGoodFromTheFirstSecond) {
    DeviceClock clock(rate);
    EXPECT_LT(worst_after({30, 17}, 1, 10, clock), 1e-3);
}

TEST(DeviceClock, TimesRiseEvenWhenReportsComeInBursts) {
    DeviceClock clock(rate);
    const Bus bus{20, 5};
    TimeNs last = 0;
    for (int n = 0; n < 20'000; ++n) {
        const double t = n * 1e-3;
        const double arrival = std::ceil(t / 0.05) * 0.05 + 1e-4;  // fifty at a time
        const TimeNs time = clock.sample(bus.ticks(t), bus.start + nanoseconds(arrival));
        ASSERT_GT(time, last);
        last = time;
    }
    EXPECT_EQ(clock.jumps(), 0u);
    EXPECT_NEAR(clock.drift_ppm(), 20, 5);
}

TEST(DeviceClock, AJumpOfTheCounterBeginsANewLine) {
    for (const std::int64_t jump : {48'000'000ll * 5, -48'000'000ll * 5, 48'000'000ll * 40}) {
        DeviceClock clock(rate);
        Bus bus{0, 1000};
        for (int n = 0; n < 2000; ++n) clock.sample(bus.ticks(n * 1e-3), bus.arrival(n * 1e-3, 1));
        bus.start_ticks += static_cast<std::uint32_t>(jump);
        TimeNs time = 0;
        for (int n = 2000; n < 5000; ++n) time = clock.sample(bus.ticks(n * 1e-3), bus.arrival(n * 1e-3, 1));
        EXPECT_EQ(clock.jumps(), 1u) << jump;
        EXPECT_NEAR(seconds(time - bus.start), 4.999, 5e-3) << jump;
    }
}

TEST(DeviceClock, OtherStampsOfTheSameCounterAreOnTheLine) {
    DeviceClock clock(rate);
    const Bus bus{30, 0xffffff00u};
    worst_after(bus, 100, 20, clock);
    EXPECT_NEAR(seconds(clock.host_time(bus.ticks(20.5)) - bus.start), 20.5002, 1e-4);
    EXPECT_NEAR(seconds(clock.host_time(bus.ticks(19.5)) - bus.start), 19.5002, 1e-4);
}

}  // namespace
}  // namespace entoptic::drivers
