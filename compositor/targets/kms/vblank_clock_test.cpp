// labels: unit
#include "compositor/targets/kms/vblank_clock.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace entoptic::compositor::kms {
namespace {

constexpr double nominal = 1e9 / 90.04;  // the Vive Pro's mode

// A display whose crystal runs 80 ppm slow, stamped in whole microseconds as page-flip events are.
struct Display {
    double period = nominal * (1 + 80e-6);
    TimeNs start = 5'000'000'123;
    TimeNs time(std::uint32_t k) const { return start + static_cast<TimeNs>(std::llround(k * period)); }
    Vblank stamp(std::uint32_t k, std::uint32_t first = 0) const { return {first + k, time(k) / 1000 * 1000}; }
};

TEST(VblankClock, FindsThePeriodAndPhaseOfADisplayBetterThanItsStamps) {
    const Display display;
    VblankClock clock(nominal);
    TimeNs worst = 0;
    for (std::uint32_t k = 0; k < 2000; ++k) {
        const auto refresh = clock.add(display.stamp(k));
        EXPECT_TRUE(refresh.believed);
        EXPECT_EQ(refresh.passed, k == 0 ? 0 : 1);
        if (k > 100)
            worst = std::max(worst, std::abs(refresh.time + 500 - display.time(k)));  // cut to microseconds: half of one on average
    }
    EXPECT_LE(worst, 350);  // ns; a stamp alone: up to 500 about its mean
    EXPECT_NEAR(static_cast<double>(clock.period()), display.period, 20);
    EXPECT_EQ(clock.disbelieved(), 0u);
}

TEST(VblankClock, BeginsWithTheModesOwnPeriod) {
    VblankClock clock(nominal);
    clock.add({7, ns_per_s});
    EXPECT_EQ(clock.period(), std::llround(nominal));
}

TEST(VblankClock, CountsRefreshesThatPassed) {
    const Display display;
    VblankClock clock(nominal);
    clock.add(display.stamp(0));
    clock.add(display.stamp(1));
    EXPECT_EQ(clock.add(display.stamp(4)).passed, 3);
    EXPECT_EQ(clock.add(display.stamp(5)).passed, 1);
}

TEST(VblankClock, GoesOnWhenTheNumberWraps) {
    const Display display;
    VblankClock clock(nominal);
    for (std::uint32_t k = 0; k < 200; ++k) {
        const auto refresh = clock.add(display.stamp(k, 0xffffffffu - 100));
        EXPECT_TRUE(refresh.believed) << k;
        if (k) { EXPECT_EQ(refresh.passed, 1) << k; }
    }
}

TEST(VblankClock, DoesNotBelieveAStampThatGoesBackOrJumps) {
    const Display display;
    for (const DurationNs off : {-30'000'000, -3'000'000, 3'000'000, 30'000'000}) {
        VblankClock clock(nominal);
        for (std::uint32_t k = 0; k < 100; ++k) clock.add(display.stamp(k));
        Vblank wrong = display.stamp(100);
        wrong.time += off;
        const auto refresh = clock.add(wrong);
        EXPECT_FALSE(refresh.believed) << off;
        EXPECT_NEAR(static_cast<double>(refresh.time), static_cast<double>(display.time(100)), 2000) << off;
        EXPECT_EQ(clock.disbelieved(), 1u);
        EXPECT_TRUE(clock.add(display.stamp(101)).believed) << off;
        EXPECT_NEAR(static_cast<double>(clock.period()), display.period, 50) << off;
    }
}

TEST(VblankClock, TimeNeverGoesBackWhateverItIsTold) {
    std::mt19937 random(1);
    VblankClock clock(nominal);
    TimeNs last = 0;
    std::uint32_t sequence = 0;
    TimeNs time = ns_per_s;
    int restarts = 0;
    for (int i = 0; i < 20'000; ++i) {
        sequence += random() % 20 == 0 ? static_cast<std::uint32_t>(random()) : 1;
        time += random() % 20 == 0 ? static_cast<TimeNs>(random() % 40'000'000) - 20'000'000 : 11'106'175;
        const auto refresh = clock.add({sequence, time});
        if (refresh.passed == 0) {  // begun anew, or nobody counts
            ++restarts;
        } else {
            EXPECT_GT(refresh.time, last);
        }
        if (refresh.time) last = refresh.time;
    }
    EXPECT_LT(restarts, 4000);
}

TEST(VblankClock, BelievesADisplayThatStaysElsewhere) {
    const Display display;
    VblankClock clock(nominal);
    for (std::uint32_t k = 0; k < 100; ++k) clock.add(display.stamp(k));
    VblankClock::Refresh refresh;
    for (std::uint32_t k = 100; k < 110; ++k) {
        Vblank moved = display.stamp(k);
        moved.time += 5'000'000;  // the mode was set anew
        refresh = clock.add(moved);
    }
    EXPECT_TRUE(refresh.believed);
    EXPECT_NEAR(static_cast<double>(refresh.time), static_cast<double>(display.time(109) + 5'000'000), 2000);
}

TEST(VblankClock, SaysWhenNobodyCounts) {
    VblankClock clock(nominal);
    clock.add({0, ns_per_s});
    EXPECT_EQ(clock.add({0, ns_per_s + 9'000'000}).time, 0);
    EXPECT_EQ(clock.add({0, ns_per_s + 25'000'000}).time, 0);
}

TEST(VblankClock, KeepsTheModesPeriodWhenTheStampsAreOfAnother) {
    VblankClock clock(nominal);
    for (std::uint32_t k = 0; k < 300; ++k) clock.add({k, ns_per_s + static_cast<TimeNs>(k * nominal * 1.05)});
    EXPECT_EQ(clock.period(), std::llround(nominal));
}

}  // namespace
}  // namespace entoptic::compositor::kms
