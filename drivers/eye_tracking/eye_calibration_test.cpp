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

}  // namespace
}  // namespace entoptic::drivers
