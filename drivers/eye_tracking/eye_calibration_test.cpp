// labels: unit
#include "drivers/eye_tracking/eye_calibration.h"

#include <cstdio>
#include <gtest/gtest.h>
#include <random>

namespace entoptic::drivers {
namespace {

// A tracker with an offset, a scale, a turn and a bend, and noise.
GazeAngles seen(GazeAngles truth, double noise, std::mt19937& random) {
    std::normal_distribution<double> draw(0, noise);
    const double x = truth.x, y = truth.y;
    return {1.1 * x + 0.06 * y + 2.5 + 0.006 * x * x + (noise > 0 ? draw(random) : 0),
            0.93 * y - 0.05 * x - 1.8 + 0.004 * x * y + (noise > 0 ? draw(random) : 0)};
}

std::vector<GazePair> pairs_at(const std::vector<GazeAngles>& targets, double noise, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<GazePair> pairs;
    for (const GazeAngles& target : targets)
        for (int i = 0; i < 60; ++i) pairs.push_back({seen(target, noise, random), target});
    return pairs;
}

const std::vector<GazeAngles> taught{{0, 0}, {-15, 0}, {15, 0}, {0, 12}, {0, -12}, {-13, 10}, {13, 10}, {-13, -10}, {13, -10}};
const std::vector<GazeAngles> held_out{{-7, 5}, {7, 5}, {-7, -5}, {7, -5}};

TEST(EyeCalibration, CorrectsWhatASecondDegreePolynomialCan) {
    const auto map = fit_gaze_map(pairs_at(taught, 0.3, 1));
    ASSERT_TRUE(map) << map.error().message;
    const auto check = pairs_at(held_out, 0.0, 2);
    const double before = median_error_deg({}, check), after = median_error_deg(*map, check);
    EXPECT_GT(before, 2);
    EXPECT_LT(after, 0.3);
    std::printf("LEDGER,eye_tracking.calibration,polynomial; 0.3 deg noise,held-out median deg,%.3g\n", after);
}

TEST(EyeCalibration, WildSamplesAreLeftOut) {
    auto pairs = pairs_at(taught, 0.3, 3);
    for (std::size_t i = 0; i < pairs.size(); i += 6) pairs[i].measured += GazeAngles(25, -20);  // one in six: looked elsewhere
    pairs[3].measured = GazeAngles(std::nan(""), 0);
    const auto map = fit_gaze_map(pairs);
    ASSERT_TRUE(map) << map.error().message;
    EXPECT_LT(median_error_deg(*map, pairs_at(held_out, 0.0, 4)), 1);
}

TEST(EyeCalibration, TooLittleOrNothingRelatedIsAnError) {
    EXPECT_FALSE(fit_gaze_map({}));
    EXPECT_FALSE(fit_gaze_map(pairs_at({{0, 0}, {10, 0}}, 0.1, 5)));
    std::mt19937 random(6);
    std::uniform_real_distribution<double> anywhere(-30, 30);
    std::vector<GazePair> pairs = pairs_at(taught, 0.1, 7);
    for (GazePair& pair : pairs) pair.measured = {anywhere(random), anywhere(random)};
    EXPECT_FALSE(fit_gaze_map(pairs));
}

TEST(EyeCalibration, TheIdentityChangesNothing) {
    for (const GazeAngles& a : taught) EXPECT_LT(glm::length(GazeMap{}.apply(a) - a), 1e-12);
    EXPECT_TRUE(GazeMap{}.sensible());
    GazeMap bad;
    bad.up[0] = std::nan("");
    EXPECT_FALSE(bad.sensible());
}

class FixedEyes final : public EyeSource {
public:
    Observer observer;
    RawEyeSample raw;
    Observer observer_at(TimeNs) override { return observer; }
    std::optional<RawEyeSample> raw_at(int, TimeNs) override { return raw; }
    bool present() const override { return true; }
    std::string description() const override { return "fixed"; }
};

TEST(EyeCalibration, ASourceGoesThroughIt) {
    FixedEyes eyes;
    eyes.observer.eyes[0].gaze_direction = glm::vec3(direction_of({3, 1}));
    eyes.observer.eyes[0].gaze_provenance = eyes.observer.eyes[0].pupil_provenance = Provenance::measured;
    eyes.observer.eyes[0].pupil_diameter_mm = 8.5f;
    eyes.raw.gaze_direction = glm::vec3(std::nanf(""));
    EyeCalibration calibration;
    calibration.gaze[0] = GazeMap{};
    calibration.gaze[0]->right[0] = -3;
    calibration.pupil_range_mm = {2.5, 6};
    CalibratedEyes calibrated(eyes, calibration);
    const Observer observer = calibrated.observer_at(0);
    EXPECT_LT(glm::length(angles_of(glm::dvec3(observer.eyes[0].gaze_direction)) - GazeAngles(0, 1)), 1e-4);
    EXPECT_NEAR(observer.eyes[0].pupil_diameter_mm, 6.6, 1e-5);
    EXPECT_TRUE(std::isnan(calibrated.raw_at(0, 0)->gaze_direction.x)) << "what is not known stays unknown";
    eyes.observer.eyes[0].gaze_provenance = Provenance::modelled;
    EXPECT_NEAR(angles_of(glm::dvec3(calibrated.observer_at(0).eyes[0].gaze_direction)).x, 3, 1e-4);
}

// A tracker of both eyes, 200 samples a second with noise, that looks at `truth` through seen() and has slipped.
class SlippingEyes final : public EyeSource {
public:
    GazeAngles truth{0}, slip{0};
    double noise = 0.3;
    std::array<float, 2> confidence{1, 1};
    double saccade_at_s = -1;  // from then on it looks 10 degrees farther right
    Observer observer_at(TimeNs) override {
        Observer observer;
        for (EyeState& eye : observer.eyes) {
            eye.gaze_direction = glm::vec3(direction_of(measured(truth)));
            eye.gaze_provenance = Provenance::measured;
        }
        return observer;
    }
    std::optional<RawEyeSample> raw_at(int eye, TimeNs time) override {
        const TimeNs exposed = time / 5'000'000 * 5'000'000;
        std::mt19937 random(static_cast<unsigned>(exposed / 5'000'000 * 2 + eye));
        std::normal_distribution<double> draw(0, noise);
        GazeAngles at = measured(truth);
        if (saccade_at_s >= 0 && seconds(exposed) >= saccade_at_s) at.x += 10;
        at += GazeAngles(draw(random), draw(random));
        RawEyeSample sample;
        sample.time = exposed;
        sample.arrival = exposed;
        sample.confidence = confidence[static_cast<std::size_t>(eye)];
        sample.gaze_direction = glm::vec3(direction_of(at));
        return sample;
    }
    bool present() const override { return true; }
    std::string description() const override { return "slipping"; }

private:
    GazeAngles measured(GazeAngles a) const {
        std::mt19937 none;
        return seen(a, 0, none) + slip;
    }
};

double error_deg(CalibratedEyes& eyes, std::size_t eye, GazeAngles truth) {
    return glm::length(angles_of(glm::dvec3(eyes.observer_at(0).eyes[eye].gaze_direction)) - truth);
}

TEST(EyeCalibration, RecentringTakesASlipOutEverywhere) {
    SlippingEyes eyes;
    EyeCalibration calibration;
    const auto map = fit_gaze_map(pairs_at(taught, 0.1, 8));
    ASSERT_TRUE(map);
    calibration.gaze = {*map, *map};
    calibration.pupil_range_mm = {2.5, 6};
    CalibratedEyes calibrated(eyes, calibration);
    EXPECT_LT(error_deg(calibrated, 0, {0, 0}), 0.2);
    eyes.slip = {4, -3};
    const auto shifts = calibrated.recentre(10 * ns_per_s, {GazeAngles(0.9, 0), GazeAngles(-0.9, 0)});
    ASSERT_TRUE(shifts) << shifts.error().message;
    // What remains at the centre is the median's noise: 0.3 degrees over the root of 80, times the median's 1.25.
    EXPECT_LT(error_deg(calibrated, 0, {0.9, 0}), 0.15);
    EXPECT_LT(error_deg(calibrated, 1, {-0.9, 0}), 0.15);
    double worst_before = 0, worst = 0;
    for (const GazeAngles& target : held_out) {
        eyes.truth = target;
        worst = std::max(worst, error_deg(calibrated, 1, target + GazeAngles(-0.9, 0)));
        CalibratedEyes slipped(eyes, calibration);
        worst_before = std::max(worst_before, error_deg(slipped, 1, target));
    }
    EXPECT_GT(worst_before, 3.5);
    EXPECT_LT(worst, 1) << "a slip shifts what was measured, the map bends it a little";
    EXPECT_EQ(calibrated.calibration().pupil_range_mm, calibration.pupil_range_mm);
}

TEST(EyeCalibration, RecentringWithoutACalibrationMakesOne) {
    SlippingEyes eyes;
    CalibratedEyes calibrated(eyes, {});
    EXPECT_EQ(calibrated.description(), "slipping");
    eyes.confidence[0] = 0.3f;
    const auto shifts = calibrated.recentre(10 * ns_per_s, {});
    ASSERT_TRUE(shifts) << shifts.error().message;
    EXPECT_FALSE((*shifts)[0]) << "that eye was not seen";
    EXPECT_FALSE(calibrated.calibration().gaze[0]);
    EXPECT_LT(error_deg(calibrated, 1, {0, 0}), 0.15);
    EXPECT_EQ(calibrated.description(), "slipping; calibrated");
}

TEST(EyeCalibration, RecentringWhatIsNoLookAtTheCentreChangesNothing) {
    const auto refused = [](SlippingEyes& eyes, const char* why) {
        CalibratedEyes calibrated(eyes, {});
        const auto shifts = calibrated.recentre(10 * ns_per_s, {});
        ASSERT_FALSE(shifts) << why;
        EXPECT_NE(shifts.error().message.find(why), std::string::npos) << shifts.error().message;
        EXPECT_TRUE(calibrated.calibration().empty());
    };
    SlippingEyes moving, closed, far;
    moving.saccade_at_s = 9.8;
    closed.confidence = {0.2f, 0.2f};
    far.slip = {25, 0};
    refused(moving, "moved");
    refused(closed, "Neither eye");
    refused(far, "entoptic calibrate gaze");
}

}  // namespace
}  // namespace entoptic::drivers
