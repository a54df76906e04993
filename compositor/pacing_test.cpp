// labels: unit
// Pacing and counting against a simulated application, compositor and display. No threads, no sleeping.
#include "compositor/pacing.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace entoptic::compositor {
namespace {

constexpr DurationNs ms = 1'000'000;
constexpr RefreshGrid grid{5 * ms, 11 * ms, 3 * ms};

TEST(RefreshGrid, FirstAt) {
    EXPECT_EQ(grid.first_at(0), 0);
    EXPECT_EQ(grid.first_at(5 * ms), 0);
    EXPECT_EQ(grid.first_at(5 * ms + 1), 1);
    EXPECT_EQ(grid.first_at(16 * ms), 1);
    EXPECT_EQ(grid.light(2), 30 * ms);
}

TEST(RefreshGrid, Nearest) {
    EXPECT_EQ(grid.nearest(5 * ms), 0);
    EXPECT_EQ(grid.nearest(10 * ms), 0);
    EXPECT_EQ(grid.nearest(11 * ms), 1);
    EXPECT_EQ(grid.nearest(-1 * ms), -1);
    EXPECT_EQ(grid.nearest(-6 * ms), -1);
    EXPECT_EQ(grid.nearest(-12 * ms), -2);
}

// The display's refreshes lie elsewhere than the grid's first guess, and its crystal is 100 ppm off.
TEST(FramePacing, FollowsADisplayThatTellsItsRefreshes) {
    const DurationNs period = 11'001'100;
    const TimeNs phase = 9 * ms;
    const auto vblank = [&](std::int64_t k) { return phase + k * period; };
    FramePacing pacing(grid);
    PresentationLog log;
    TimeNs now = 0;
    std::int64_t last = -1;
    for (int i = 0; i < 100'000; ++i) {
        const bool late = i % 1000 == 999;  // the driver needs a refresh more

        const FramePacing::Prediction p = pacing.predict(now);
        const FramePacing::Plan plan = pacing.plan(now);
        now = std::max(now, plan.wake_time);
        pacing.taken(plan.refresh, now, true);
        now += 2 * ms;
        const std::int64_t k = (now - phase + period - 1) / period + late;
        const std::int64_t shown = pacing.composed(now, vblank(k), period);
        EXPECT_EQ(pacing.grid().deadline(shown), vblank(k));
        if (i > 0) {
            ASSERT_EQ(shown, last + 1 + late);  // none counted twice
        }
        log.shown(static_cast<std::uint64_t>(i), shown, vblank(k) + grid.vblank_to_photon);
        if (i > 0) {  // what is promised is a refresh, to the nanosecond
            ASSERT_EQ((p.display_time - grid.vblank_to_photon - phase) % period, 0);
        }
        last = shown;
        now = vblank(k);
    }
    EXPECT_EQ(log.counts().missed, 100u);  // those of the display, and no others
    EXPECT_EQ(log.counts().displayed, 100'000u);
}

TEST(PresentationLog, PicturesOfADisplayThatIsAwayAreNotShownAndNotMissed) {
    PresentationLog log;
    for (std::uint64_t id = 1; id <= 3; ++id) {
        log.predicted(id, ns_per_s);
        log.submitted(id, ns_per_s);
    }
    log.shown(1, 10, ns_per_s);
    log.unseen();
    log.unseen();
    log.shown(1, 20, 2 * ns_per_s);  // it is back, and shows what it showed
    log.shown(3, 21, 3 * ns_per_s);
    EXPECT_EQ(log.counts().displayed, 2u);
    EXPECT_EQ(log.counts().reused, 1u);
    EXPECT_EQ(log.counts().missed, 0u);
    EXPECT_EQ(log.counts().unseen, 2u);
    EXPECT_EQ(log.records(3)[1].refreshes_shown, 0u);
    EXPECT_EQ(log.records(3)[1].display_time, 0);
}

TEST(DurationEstimate, IgnoresOneHiccupButNotAHabit) {
    DurationEstimate estimate(7);
    EXPECT_EQ(estimate.value(), 7);
    estimate.add(100);
    EXPECT_EQ(estimate.value(), 100);
    for (int i = 0; i < 7; ++i) estimate.add(10);
    EXPECT_EQ(estimate.value(), 10);
    estimate.add(50);
    estimate.add(50);
    EXPECT_EQ(estimate.value(), 50);
    for (int i = 0; i < 8; ++i) estimate.add(10);
    EXPECT_EQ(estimate.value(), 10);
}

// One application thread (wait, render, submit) and one compositor, in steps of 0.1 ms, following the rules of CompositorService.
struct Simulation {
    DurationNs render = 4 * ms, compose = 2 * ms;
    TimeNs stall_from = 0, stall_until = 0;  // the application does nothing

    FramePacing pacing{grid};
    PresentationLog log;
    std::vector<std::int64_t> shown;  // refresh of each composition

    void run(TimeNs until) {
        for (TimeNs now = 0; now < until; now += ms / 10) step(now);
    }

private:
    struct Frame {
        std::uint64_t id = 0;
        std::int64_t promised = 0;
        bool shown = false;
    };
    enum class App { waiting, starting, rendering } app = App::waiting;
    FramePacing::Prediction prediction;
    TimeNs begun = 0;
    std::uint64_t next_id = 1;
    std::optional<Frame> queued, current;
    std::optional<TimeNs> composed_at;
    std::optional<FramePacing::Plan> plan;

    void step(TimeNs now) {
        application(now);
        compositor(now);
    }
    void application(TimeNs now) {
        if (now >= stall_from && now < stall_until && app != App::rendering) return;
        if (app == App::waiting && !queued) {
            prediction = pacing.predict(now);
            log.predicted(next_id, prediction.display_time);
            app = App::starting;
        }
        if (app == App::starting && now >= prediction.start_time) {
            begun = now;
            app = App::rendering;
        }
        if (app == App::rendering && now >= begun + render) {
            pacing.application_took(now - begun);
            log.submitted(next_id, now);
            queued = Frame{next_id++, prediction.refresh};
            app = App::waiting;
        }
    }
    void compositor(TimeNs now) {
        if (composed_at) {
            if (now < *composed_at) return;
            composed_at.reset();
            const std::int64_t at = pacing.composed(now);
            log.shown(current->id, at, grid.light(at));
            current->shown = true;
            shown.push_back(at);
        }
        if (!plan && (queued || (current && pacing.keeps_up()))) plan = pacing.plan(now);
        if (!plan || now < plan->wake_time) return;
        const std::int64_t refresh = plan->refresh;
        plan.reset();
        bool fresh = false;
        if (queued && pacing.may_show(queued->promised, refresh)) {
            current = queued;
            queued.reset();
            fresh = true;
        }
        const bool something = current && (fresh || pacing.keeps_up());
        pacing.taken(refresh, now, something);
        if (something) composed_at = now + compose;
    }
};

void expect_consistent(const Simulation& s) {
    // Every refresh from the first light to the last is new, reprojected or missed.
    const FrameCounts& c = s.log.counts();
    EXPECT_EQ(std::int64_t(c.displayed + c.reused + c.missed), s.shown.back() - s.shown.front() + 1);
    EXPECT_TRUE(std::is_sorted(s.shown.begin(), s.shown.end()));
    EXPECT_EQ(std::adjacent_find(s.shown.begin(), s.shown.end()), s.shown.end());
    TimeNs before = 0;
    std::uint64_t shown = 0;
    for (const PresentationRecord& record : s.log.records(100000)) {
        EXPECT_GT(record.predicted_display_time, before);
        EXPECT_EQ((record.predicted_display_time - grid.light(0)) % grid.period, 0);
        before = record.predicted_display_time;
        shown += record.refreshes_shown;
        EXPECT_EQ(record.display_time == 0, record.refreshes_shown == 0);
    }
    EXPECT_EQ(shown, c.displayed + c.reused + c.missed);
}

TEST(Pacing, AFastApplicationGetsEveryRefresh) {
    Simulation s;
    s.run(2 * ns_per_s);
    expect_consistent(s);
    const FrameCounts& c = s.log.counts();
    EXPECT_GT(c.displayed, 170u);  // of 181
    EXPECT_LT(c.reused, 5u);
    EXPECT_EQ(c.missed, 0u);
    int kept = 0, total = 0;  // promises, after the beginning
    for (const PresentationRecord& record : s.log.records(150))
        if (record.display_time) {
            ++total;
            kept += record.display_time == record.predicted_display_time;
        }
    EXPECT_EQ(kept, total);
}

TEST(Pacing, ASlowApplicationIsReprojectedEveryRefresh) {
    Simulation s;
    s.render = 30 * ms;
    s.run(3 * ns_per_s);
    expect_consistent(s);
    const FrameCounts& c = s.log.counts();
    EXPECT_EQ(c.missed, 0u);
    EXPECT_GT(c.displayed, 60u);  // about every third or fourth
    EXPECT_GT(c.reused, c.displayed);
}

TEST(Pacing, ASlowCompositorMissesAndDoesNotReproject) {
    Simulation s;
    s.compose = 100 * ms;
    s.run(10 * ns_per_s);
    expect_consistent(s);
    const FrameCounts& c = s.log.counts();
    EXPECT_LE(c.reused, 3u);  // before it is known how slow it is
    EXPECT_GT(c.missed, 700u);
    EXPECT_GT(c.displayed, 90u);  // composing is the only limit: the application renders meanwhile
    // What was promised is when it was seen, to within a period or two.
    for (const PresentationRecord& record : s.log.records(50))
        if (record.display_time) { EXPECT_LE(std::abs(record.display_time - record.predicted_display_time), 2 * grid.period); }
}

TEST(Pacing, AStalledApplicationIsReprojectedUntilItReturns) {
    Simulation s;
    s.stall_from = ns_per_s;
    s.stall_until = 11 * ns_per_s;
    s.run(12 * ns_per_s);
    expect_consistent(s);
    EXPECT_GT(s.log.counts().reused, 890u);  // 10 s at 90.9 Hz
    EXPECT_EQ(s.log.counts().missed, 0u);
    EXPECT_GT(s.log.counts().displayed, 160u);
}

TEST(Pacing, NobodyRunsAheadByMoreThanAFrame) {
    Simulation s;
    s.render = ms / 10;
    s.run(ns_per_s);
    expect_consistent(s);
    EXPECT_LE(s.log.counts().submitted, s.log.counts().displayed + 2);
}

// What xrWaitFrame says of the time between frames is the pace that the application is kept to, in whole refreshes, at most sixteen.
TEST(Pacing, TellsThePeriodOfThePace) {
    for (const auto& [every, told] : {std::pair(11 * ms, 11 * ms), {22 * ms, 22 * ms}, {33 * ms, 33 * ms}, {330 * ms, 176 * ms}}) {
        FramePacing pacing(grid);
        FramePacing::Prediction prediction;
        for (TimeNs now = 0; now < 20 * every; now += every) prediction = pacing.predict(now);
        EXPECT_EQ(prediction.period, told) << every;
        prediction = pacing.predict(20 * every + 1000 * ms);
        EXPECT_EQ(prediction.period, told) << "one long pause does not change it";
    }
}

TEST(PresentationLog, AFrameReplacedBeforeItWasShown) {
    PresentationLog log;
    for (std::uint64_t id : {1, 2, 3}) log.predicted(id, TimeNs(id) * 11 * ms), log.submitted(id, TimeNs(id) * ms);
    log.shown(1, 10, 110);
    log.shown(3, 11, 121);
    log.shown(3, 12, 132);
    log.shown(3, 15, 165);
    const auto records = log.records(10);
    EXPECT_EQ(records[0].refreshes_shown, 1u);
    EXPECT_EQ(records[1].refreshes_shown, 0u);
    EXPECT_EQ(records[1].display_time, 0);
    EXPECT_EQ(records[2].refreshes_shown, 5u);  // three times composed, two refreshes it stood
    EXPECT_EQ(records[2].display_time, 121);
    EXPECT_EQ(log.counts().displayed, 2u);
    EXPECT_EQ(log.counts().reused, 2u);
    EXPECT_EQ(log.counts().missed, 2u);
    EXPECT_EQ(log.records(1).front().frame_id, 3u);
}

TEST(PresentationLog, ForgetsTheOldest) {
    PresentationLog log(3);
    for (std::uint64_t id = 1; id <= 10; ++id) log.predicted(id, TimeNs(id));
    EXPECT_EQ(log.records(100).size(), 3u);
    EXPECT_EQ(log.records(100).front().frame_id, 8u);
}

}  // namespace
}  // namespace entoptic::compositor
