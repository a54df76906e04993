// labels: unit
// The rules of facts/perception.md 3.1c and facts/devices.md 4.7, on constructed samples.
#include "base/noise.h"
#include "drivers/eye_tracking/eye_filter.h"

#include <bit>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <thread>
#include <vector>

namespace entoptic::drivers {
namespace {

constexpr DurationNs ms = 1'000'000;
constexpr DurationNs period = 5 * ms, latency = 10 * ms;
constexpr TimeNs start = 1000 * ns_per_s;
const float nan_value = std::numeric_limits<float>::quiet_NaN();

RawEyeSample good(TimeNs time, GazeAngles gaze = {0, 0}, double pupil = 4) {
    RawEyeSample sample;
    sample.time = time;
    sample.arrival = time + latency;
    sample.gaze_direction = glm::vec3(direction_of(gaze));
    sample.pupil_diameter_mm = static_cast<float>(pupil);
    sample.confidence = 1;
    return sample;
}

RawEyeSample nothing(TimeNs time) {
    RawEyeSample sample = good(time);
    sample.gaze_direction = glm::vec3(nan_value);
    sample.pupil_diameter_mm = 0;
    sample.confidence = 0;
    return sample;
}

// Feeds both eyes from `from` to `to` (seconds after start) with what `make` gives; none = no sample.
using Make = std::function<std::optional<RawEyeSample>(int eye, TimeNs time)>;
void feed(EyeFilter& filter, double from, double to, const Make& make) {
    for (auto k = std::llround(from * 200); k < std::llround(to * 200); ++k) {
        for (int eye = 0; eye < 2; ++eye) {
            if (const auto sample = make(eye, start + k * period)) filter.add(eye, *sample);
        }
    }
}

// A filter that can be asked about a whole test.
EyeFilterParameters long_memory() {
    EyeFilterParameters parameters;
    parameters.history = 100 * ns_per_s;
    return parameters;
}

TimeNs at(double s) { return start + static_cast<DurationNs>(std::llround(s * 1e9)); }
Observer ask(const EyeFilter& filter, double s) { return filter.observer_at(at(s), at(s)); }
GazeAngles gaze(const Observer& observer, int eye = 0) {
    return angles_of(glm::dvec3(observer.eyes[static_cast<std::size_t>(eye)].gaze_direction));
}
double pupil(const Observer& observer) { return observer.eyes[0].pupil_diameter_mm; }

bool sound(const EyeState& eye) {
    return std::abs(glm::length(eye.gaze_direction) - 1) < 1e-5f && eye.pupil_diameter_mm >= 1.5f && eye.pupil_diameter_mm <= 9 &&
           eye.eyelid_open >= 0 && eye.eyelid_open <= 1 && eye.confidence >= 0 && eye.confidence <= 1;
}

bool equal(const Observer& a, const Observer& b) {
    bool same = a.gaze_direction == b.gaze_direction;
    for (std::size_t e = 0; e < 2; ++e) {
        const EyeState &x = a.eyes[e], &y = b.eyes[e];
        same = same && x.gaze_direction == y.gaze_direction && x.gaze_provenance == y.gaze_provenance &&
               x.pupil_diameter_mm == y.pupil_diameter_mm && x.pupil_provenance == y.pupil_provenance && x.eyelid_open == y.eyelid_open &&
               x.confidence == y.confidence && x.sample_time == y.sample_time;
    }
    return same;
}

TEST(EyeFilter, KnowsNothingAtFirst) {
    const EyeFilter filter;
    const Observer observer = ask(filter, 0);
    for (const EyeState& eye : observer.eyes) {
        EXPECT_EQ(eye.gaze_provenance, Provenance::absent);
        EXPECT_EQ(eye.pupil_provenance, Provenance::absent);
        EXPECT_FLOAT_EQ(eye.pupil_diameter_mm, 4);
        EXPECT_FLOAT_EQ(eye.gaze_direction.z, -1);
        EXPECT_FLOAT_EQ(eye.eyelid_open, 1);
        EXPECT_EQ(eye.sample_time, 0);
    }
    EXPECT_FALSE(filter.raw_at(0, at(5)));
}

TEST(EyeFilter, TheFirstMeasurementIsTakenAsItIs) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 0.01, [](int, TimeNs t) { return good(t, {12, -5}, 2.5); });
    const Observer observer = ask(filter, 0.02);
    EXPECT_NEAR(pupil(observer), 2.5, 1e-6);
    EXPECT_NEAR(gaze(observer).x, 12, 1e-4);
    EXPECT_NEAR(gaze(observer).y, -5, 1e-4);
    EXPECT_EQ(observer.eyes[0].gaze_provenance, Provenance::measured);
    EXPECT_EQ(observer.eyes[0].pupil_provenance, Provenance::measured);
    EXPECT_EQ(observer.eyes[0].sample_time, at(0.005));
}

TEST(EyeFilter, BothPupilsAreAveraged) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 3, [](int eye, TimeNs t) { return good(t, {0, 0}, eye == 0 ? 3 : 5); });
    EXPECT_NEAR(pupil(ask(filter, 3)), 4, 1e-3);
    EXPECT_EQ(ask(filter, 3).eyes[0].pupil_diameter_mm, ask(filter, 3).eyes[1].pupil_diameter_mm);
}

TEST(EyeFilter, OnePupilIsEnough) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 3, [](int eye, TimeNs t) { return good(t, {0, 0}, eye == 0 ? 3 : 0); });
    const Observer observer = ask(filter, 3);
    EXPECT_NEAR(pupil(observer), 3, 1e-6);
    EXPECT_EQ(observer.eyes[0].pupil_provenance, Provenance::measured);
    EXPECT_EQ(observer.eyes[1].pupil_provenance, Provenance::modelled);
}

// Large steps are limited by the speeds of a pupil, small ones by the low-pass.
TEST(EyeFilter, PupilSpeedIsLimited) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 4, [](int, TimeNs t) { return good(t, {0, 0}, t < at(1) ? 2 : t < at(3) ? 8 : 2); });
    const double dark = pupil(ask(filter, 2.0)) - pupil(ask(filter, 1.5));
    EXPECT_NEAR(dark / 0.5, 2, 0.01);
    const double light = pupil(ask(filter, 3.4)) - pupil(ask(filter, 3.2));
    EXPECT_NEAR(light / 0.2, -6, 0.05);
}

TEST(EyeFilter, PupilLowPassHasATimeConstantOfATenthOfASecond) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 2, [](int, TimeNs t) { return good(t, {0, 0}, t < at(1) ? 4 : 4.15); });
    EXPECT_NEAR((pupil(ask(filter, 1.01 + 0.1)) - 4) / 0.15, 1 - std::exp(-1), 0.01);
}

TEST(EyeFilter, LostPupilIsHeldThenRelaxesToTheModel) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 1, [](int, TimeNs t) { return good(t, {0, 0}, 6); });
    feed(filter, 1, 6, [](int, TimeNs t) { return nothing(t); });
    const double last = 0.995 + 0.01;  // arrival of the last valid sample
    EXPECT_NEAR(pupil(ask(filter, last + 0.5)), 6, 1e-3);
    EXPECT_EQ(ask(filter, last + 0.49).eyes[0].pupil_provenance, Provenance::measured);
    EXPECT_EQ(ask(filter, last + 0.51).eyes[0].pupil_provenance, Provenance::modelled);
    // After a second of relaxation with tau 1 s, seen through the 0.1 s low-pass.
    EXPECT_NEAR(pupil(ask(filter, last + 1.5)), 4 + 2 * (std::exp(-1.0) - 0.1 * std::exp(-10.0)) / 0.9, 0.01);
    EXPECT_NEAR(pupil(ask(filter, 6)), 4, 0.05);
}

// A tracker that falls silent (no samples at all) gives the same course as one that says nothing is found.
TEST(EyeFilter, SilenceAndNothingFoundAgreeAboutThePupil) {
    EyeFilter silent(long_memory()), blind(long_memory());
    for (EyeFilter* filter : {&silent, &blind}) feed(*filter, 0, 1, [](int, TimeNs t) { return good(t, {0, 0}, 7); });
    feed(blind, 1, 2.9, [](int, TimeNs t) { return nothing(t); });
    for (double t : {1.2, 1.6, 2.0, 2.5, 2.9}) EXPECT_NEAR(pupil(ask(silent, t)), pupil(ask(blind, t)), 2e-3) << t;
}

TEST(EyeFilter, SilenceBecomesAbsence) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 1, [](int, TimeNs t) { return good(t, {10, 0}, 6); });
    EXPECT_EQ(ask(filter, 1.1).eyes[0].gaze_provenance, Provenance::measured);
    EXPECT_EQ(ask(filter, 1.5).eyes[0].gaze_provenance, Provenance::modelled);
    EXPECT_EQ(ask(filter, 1.4).eyes[0].pupil_provenance, Provenance::measured);
    EXPECT_EQ(ask(filter, 1.8).eyes[0].pupil_provenance, Provenance::modelled);
    const Observer absent = ask(filter, 2.1);
    EXPECT_EQ(absent.eyes[0].gaze_provenance, Provenance::absent);
    EXPECT_EQ(absent.eyes[0].pupil_provenance, Provenance::absent);
    EXPECT_FLOAT_EQ(absent.eyes[0].confidence, 0);
    EXPECT_NE(filter.status(at(2.1)).find("no samples for 1.1 s"), std::string::npos) << filter.status(at(2.1));
    const Observer later = ask(filter, 100);
    EXPECT_NEAR(pupil(later), 4, 1e-6);
    EXPECT_NEAR(gaze(later).x, 0, 1e-3);
}

TEST(EyeFilter, LostGazeIsHeldThenEasesToTheCentre) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 1, [](int, TimeNs t) { return good(t, {20, 10}); });
    const double last = 0.995 + 0.01;
    EXPECT_NEAR(gaze(ask(filter, last + 0.149)).x, 20, 1e-3);
    EXPECT_NEAR(gaze(ask(filter, last + 0.15 + 0.3)).x, 20 * std::exp(-1.0), 1e-2);
    EXPECT_NEAR(gaze(ask(filter, last + 0.15 + 0.3)).y, 10 * std::exp(-1.0), 1e-2);
}

TEST(EyeFilter, ABlindEyeFollowsTheSeeingOne) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 1, [](int eye, TimeNs t) { return good(t, {eye == 0 ? 6 : 4, 0}); });  // 2 degrees of vergence
    feed(filter, 1, 6, [](int eye, TimeNs t) { return eye == 0 ? good(t, {-9, 3}) : nothing(t); });
    const Observer observer = ask(filter, 6);
    EXPECT_EQ(observer.eyes[0].gaze_provenance, Provenance::measured);
    EXPECT_EQ(observer.eyes[1].gaze_provenance, Provenance::modelled);
    EXPECT_NEAR(gaze(observer, 1).x, -11, 0.05);
    EXPECT_NEAR(gaze(observer, 1).y, 3, 0.05);
}

TEST(EyeFilter, BlinkHoldsTheGazeOfBeforeAndMovesTheLid) {
    EyeFilter filter(long_memory());
    // From 0.97 s on the closing lid drags the gaze down, still with good confidence; from 1.0 to 1.3 s nothing is found.
    feed(filter, 0, 2, [](int, TimeNs t) {
        if (t >= at(1.0) && t < at(1.3)) return nothing(t);
        return good(t, {5, t >= at(0.97) && t < at(1.0) ? 5 - 0.7 * (seconds(t - at(0.97)) / 0.03) : 5});
    });
    const double detected = 1.0 + 0.045 + 0.01;  // the tenth low sample is the first later than 40 ms
    EXPECT_FLOAT_EQ(ask(filter, detected - 0.001).eyes[0].eyelid_open, 1);
    EXPECT_NEAR(ask(filter, detected + 0.05).eyes[0].eyelid_open, 0.5, 1e-3);
    EXPECT_NEAR(ask(filter, detected + 0.1).eyes[0].eyelid_open, 0, 1e-6);
    EXPECT_FLOAT_EQ(ask(filter, 1.30).eyes[0].eyelid_open, 0);
    EXPECT_NEAR(ask(filter, 1.31 + 0.1).eyes[0].eyelid_open, 0.5, 1e-3);
    EXPECT_FLOAT_EQ(ask(filter, 1.31 + 0.2).eyes[0].eyelid_open, 1);
    for (double t = detected; t < 1.3; t += 0.01) EXPECT_NEAR(gaze(ask(filter, t)).y, 5, 0.02) << t;
    EXPECT_EQ(ask(filter, 1.2).eyes[0].gaze_provenance, Provenance::modelled);
    EXPECT_NE(filter.status(at(1.2)).find("blink"), std::string::npos);
    EXPECT_NE(filter.status(at(1.9)).find("tracked"), std::string::npos);
}

TEST(EyeFilter, SamplesRightAfterABlinkAreNotUsed) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 2, [](int, TimeNs t) {
        if (t >= at(1.0) && t < at(1.3)) return nothing(t);
        return good(t, {t >= at(1.3) && t < at(1.33) ? 30.0 : 5.0, 0}, t >= at(1.3) && t < at(1.33) ? 2 : 6);
    });
    for (double t = 1.3; t < 1.5; t += 0.003) {
        EXPECT_NEAR(gaze(ask(filter, t)).x, 5, 0.01) << t;
        EXPECT_NEAR(pupil(ask(filter, t)), 6, 1e-3) << t;
    }
}

TEST(EyeFilter, AShortDropoutIsNoBlink) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 2, [](int, TimeNs t) { return t >= at(1.0) && t < at(1.035) ? nothing(t) : good(t, {5, 0}); });
    for (double t = 0.9; t < 1.5; t += 0.003) {
        EXPECT_FLOAT_EQ(ask(filter, t).eyes[0].eyelid_open, 1);
        EXPECT_EQ(ask(filter, t).eyes[0].gaze_provenance, Provenance::measured);
    }
}

TEST(EyeFilter, AnEyeLostForLongOpensItsLid) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 1, [](int, TimeNs t) { return good(t); });
    feed(filter, 1, 4, [](int, TimeNs t) { return nothing(t); });
    EXPECT_FLOAT_EQ(ask(filter, 3.9).eyes[0].eyelid_open, 1);
    EXPECT_NE(filter.status(at(3.9)).find("no pupil found for"), std::string::npos) << filter.status(at(3.9));
}

TEST(EyeFilter, ASaccadePassesAtOnceAndFixationIsSmoothed) {
    EyeFilter filter(long_memory());
    const auto noisy = [](int eye, TimeNs t) {
        const auto k = static_cast<std::uint64_t>((t - start) / period);
        const GazeAngles noise =
            0.2 * GazeAngles{normal(static_cast<std::uint64_t>(eye) + 1, 2 * k), normal(static_cast<std::uint64_t>(eye) + 1, 2 * k + 1)};
        return good(t, GazeAngles{t < at(2) ? 0 : 10, 0} + noise);
    };
    feed(filter, 0, 3.9, noisy);
    EXPECT_NEAR(gaze(ask(filter, 2.0 + 0.010 + 0.006)).x, 10, 1.0);  // the second sample of the new place has arrived
    double sum = 0;
    int count = 0;
    for (double t = 2.3; t < 3.9; t += 0.005, ++count) sum += std::pow(glm::length(gaze(ask(filter, t)) - GazeAngles(10, 0)), 2);
    EXPECT_LT(std::sqrt(sum / count), 0.08);  // raw: 0.28
}

TEST(EyeFilter, OneWildSampleChangesNothing) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 2, [](int, TimeNs t) { return good(t, {t == at(1.0) ? 25.0 : 0.0, 0}); });
    for (double t = 0.9; t < 1.9; t += 0.002) EXPECT_NEAR(gaze(ask(filter, t)).x, 0, 1e-3) << t;
}

TEST(EyeFilter, PursuitIsPredicted) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 2, [](int, TimeNs t) { return good(t, {20 * seconds(t - at(1)), 0}); });  // 20 deg/s
    const TimeNs asked = at(1.9) + 11 * ms;                                                   // 21 ms and more after the newest exposure
    const double error = gaze(filter.observer_at(at(1.9), asked)).x - 20 * seconds(asked - at(1));
    EXPECT_LT(std::abs(error), 0.3);  // unpredicted: 0.4 by delay alone, more by smoothing
    const Observer far = filter.observer_at(at(1.9), at(1.9) + 10 * ns_per_s);
    EXPECT_LT(gaze(far).x - gaze(filter.observer_at(at(1.9), at(1.9))).x, 2);
}

TEST(EyeFilter, GazeStaysInsideTheView) {
    EyeFilterParameters parameters;
    parameters.gaze_limits[0] = {-0.5f, 0.5f, 0.4f, -0.4f};
    EyeFilter filter(parameters);
    feed(filter, 0, 1, [](int, TimeNs t) { return good(t, {50, 50}); });
    EXPECT_NEAR(gaze(ask(filter, 1)).x, 0.5 * degrees_per_radian, 1e-3);
    EXPECT_NEAR(gaze(ask(filter, 1)).y, 0.4 * degrees_per_radian, 1e-3);
}

TEST(EyeFilter, ImplausiblePupilsAreNotBelieved) {
    for (double bad : {0.0, -3.0, 1.49, 9.01, 15.0, 30.0, 1e30, double(INFINITY), double(NAN)}) {
        EyeFilter filter(long_memory());
        feed(filter, 0, 1, [](int, TimeNs t) { return good(t, {0, 0}, 5); });
        feed(filter, 1, 1.3, [&](int, TimeNs t) { return good(t, {0, 0}, bad); });
        EXPECT_NEAR(pupil(ask(filter, 1.3)), 5, 1e-3) << bad;
    }
}

TEST(EyeFilter, LowConfidenceIsNotBelieved) {
    for (float confidence : {0.0f, 0.55f, -1.0f, 2.0f, nan_value}) {
        EyeFilter filter(long_memory());
        feed(filter, 0, 1, [](int, TimeNs t) { return good(t, {0, 0}, 5); });
        feed(filter, 1, 1.1, [&](int, TimeNs t) {
            RawEyeSample sample = good(t, {30, 0}, 2);
            sample.confidence = confidence;
            return sample;
        });
        EXPECT_NEAR(pupil(ask(filter, 1.1)), 5, 1e-3);
        EXPECT_NEAR(gaze(ask(filter, 1.1)).x, 0, 1e-3);
    }
}

RawEyeSample random_sample(std::uint64_t k, TimeNs arrival) {
    const auto bits = [&](std::uint64_t i) { return std::bit_cast<float>(static_cast<std::uint32_t>(mix64(k * 8 + i) >> 32)); };
    RawEyeSample sample;
    sample.arrival = arrival;
    sample.time = k % 16 == 0 ? static_cast<TimeNs>(mix64(k)) : arrival - static_cast<DurationNs>(mix64(k) % (20 * ms));
    sample.gaze_direction = {bits(0), bits(1), bits(2)};
    sample.pupil_diameter_mm = bits(3);
    sample.confidence = bits(4);
    // Half of them have some plausible parts, so that garbage gets past the first checks.
    if (mix64(k) & 1) sample.confidence = 1;
    if (mix64(k) & 2) sample.pupil_diameter_mm = 1 + static_cast<float>(mix64(k) % 100) * 0.1f;
    if (mix64(k) & 4) sample.gaze_direction = glm::vec3(direction_of({double(mix64(k) % 180) - 90, double(mix64(k + 1) % 180) - 90}));
    return sample;
}

TEST(EyeFilter, NoGarbageGetsThrough) {
    EyeFilter filter;
    double last = 4;
    TimeNs last_time = start, arrival = start;
    bool begun = false;
    for (std::uint64_t k = 0; k < 100'000; ++k) {
        arrival += static_cast<DurationNs>(mix64(~k) % (6 * ms));
        filter.add(static_cast<int>(mix64(k + 7) % 2), random_sample(k, arrival));
        const Observer observer = filter.observer_at(arrival, arrival + 11 * ms);
        ASSERT_TRUE(sound(observer.eyes[0]) && sound(observer.eyes[1])) << k;
        ASSERT_NEAR(glm::length(observer.gaze_direction), 1, 1e-5);
        const double now = pupil(observer), dt = seconds(arrival - last_time);
        if (begun) {
            ASSERT_LE(now - last, 2 * dt + 1e-5) << k;
            ASSERT_GE(now - last, -6 * dt - 1e-5) << k;
        }
        begun =
            begun || observer.eyes[0].pupil_provenance == Provenance::measured || observer.eyes[1].pupil_provenance == Provenance::measured;
        last = now;
        last_time = arrival;
    }
}

TEST(EyeFilter, ExtremeTimesAreSurvived) {
    constexpr TimeNs low = std::numeric_limits<TimeNs>::min(), high = std::numeric_limits<TimeNs>::max();
    EyeFilter filter(long_memory());
    feed(filter, 0, 0.1, [](int, TimeNs t) { return good(t); });
    RawEyeSample sample = good(at(0.2));
    for (TimeNs time : {low, TimeNs{0}, high}) {
        for (TimeNs arrival : {low, TimeNs{0}, high}) {
            sample.time = time;
            sample.arrival = arrival;
            filter.add(0, sample);
        }
    }
    filter.add(2, good(at(0.2)));
    filter.add(-1, good(at(0.2)));
    for (TimeNs known : {low, TimeNs{0}, start, high}) {
        for (TimeNs time : {low, TimeNs{0}, start, high}) {
            const Observer observer = filter.observer_at(known, time);
            EXPECT_TRUE(sound(observer.eyes[0]) && sound(observer.eyes[1]));
            EXPECT_EQ(observer.time, time);
        }
    }
}

TEST(EyeFilter, LateAndRepeatedSamplesAreLeftOut) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 1, [](int, TimeNs t) { return good(t, {0, 0}, 5); });
    const Observer before = ask(filter, 1.2);
    filter.add(0, good(at(0.5), {30, 0}, 2));    // out of order
    filter.add(0, good(at(0.995), {30, 0}, 2));  // the last one again
    EXPECT_TRUE(equal(before, ask(filter, 1.2)));
}

TEST(EyeFilter, TheAnswersDoNotDependOnTheQuestions) {
    const auto make = [](int eye, TimeNs t) -> std::optional<RawEyeSample> {
        const auto k = static_cast<std::uint64_t>((t - start) / period) * 2 + static_cast<std::uint64_t>(eye);
        if (mix64(k) % 20 == 0) return std::nullopt;
        if (mix64(k / 60) % 3 == 0) return nothing(t);
        return good(t, {20 * uniform01(3, k / 100) + 0.2 * normal(1, k), 0.2 * normal(2, k)}, 4 + 2 * uniform01(4, k / 150));
    };
    EyeFilter asked_often(long_memory()), asked_late(long_memory());
    std::vector<Observer> answers;
    for (int step = 0; step < 150; ++step) {
        feed(asked_often, step * 0.01, (step + 1) * 0.01, make);
        answers.push_back(ask(asked_often, (step + 1) * 0.01));
        (void)ask(asked_often, step * 0.003);
    }
    feed(asked_late, 0, 1.5, make);
    for (int step = 149; step >= 0; --step)
        EXPECT_TRUE(equal(answers[static_cast<std::size_t>(step)], ask(asked_late, (step + 1) * 0.01))) << step;
}

TEST(EyeFilter, RawNeverComesBeforeItArrived) {
    EyeFilter filter(long_memory());
    feed(filter, 0, 1, [](int, TimeNs t) { return good(t); });
    for (double t = 0; t < 1.2; t += 0.0013) {
        const auto sample = filter.raw_at(1, at(t));
        ASSERT_EQ(sample.has_value(), at(t) >= start + latency) << t;
        if (!sample) continue;
        EXPECT_LE(sample->arrival, at(t));
        EXPECT_GT(sample->arrival + period, std::min(at(t), at(1)));
    }
}

TEST(EyeFilter, MemoryIsBounded) {
    EyeFilter filter;
    feed(filter, 0, 60, [](int, TimeNs t) { return good(t); });
    EXPECT_FALSE(filter.raw_at(0, at(50)));  // forgotten
    EXPECT_TRUE(filter.raw_at(0, at(58.5)));
    EXPECT_EQ(ask(filter, 30).eyes[0].gaze_provenance, Provenance::measured);  // the oldest state that is kept
}

TEST(EyeFilter, ManyThreadsMayAsk) {
    EyeFilter filter(long_memory());
    std::thread writer([&] { feed(filter, 0, 5, [](int, TimeNs t) { return good(t, {5, 0}); }); });
    std::vector<std::thread> readers;
    for (int i = 0; i < 3; ++i) {
        readers.emplace_back([&] {
            for (int k = 0; k < 500; ++k) {
                const Observer observer = ask(filter, k * 0.01);
                EXPECT_TRUE(sound(observer.eyes[0]));
                (void)filter.raw_at(0, at(k * 0.01));
                (void)filter.status(at(k * 0.01));
            }
        });
    }
    writer.join();
    for (std::thread& reader : readers) reader.join();
}

TEST(GazeAngles, RoundTrip) {
    for (double right = -80; right <= 80; right += 20) {
        for (double up = -80; up <= 80; up += 20)
            EXPECT_LT(glm::length(angles_of(direction_of({right, up})) - GazeAngles(right, up)), 1e-9);
    }
    EXPECT_NEAR(direction_of({90, 0}).x, 1, 1e-12);
    EXPECT_NEAR(direction_of({0, 90}).y, 1, 1e-12);
}

}  // namespace
}  // namespace entoptic::drivers
