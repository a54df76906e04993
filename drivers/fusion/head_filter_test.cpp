// labels: unit
#include "drivers/fusion/head_filter.h"

#include "base/testing/ledger.h"
#include "drivers/fusion/pose_history.h"
#include "drivers/fusion/testing/head_motion.h"

#include <gtest/gtest.h>

namespace entoptic::drivers {
namespace {

using namespace entoptic::drivers::testing;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double degrees = 180 / std::numbers::pi;

struct Worst {
    double tilt = 0, all = 0, predicted = 0;  // degrees; predicted: 20 ms ahead
};

Quaterniond quaternion(const glm::quat& q) { return {double(q.w), double(q.x), double(q.y), double(q.z)}; }

// `length` seconds at 1 kHz; errors from `settle` on.
Worst follow(HeadFilter& filter, const HeadMotion& motion, const SensorErrors& errors, double settle, double length, double from = 0) {
    Worst worst;
    for (int n = 0; n < static_cast<int>(length * 1000); ++n) {
        const double t = from + n * 1e-3;
        filter.inertial(inertial_sample(motion, errors, t, Vector3d::Zero()));
        if (t < settle) continue;
        const Quaterniond truth = motion.orientation(t);
        worst.tilt = std::max(worst.tilt, tilt_between(filter.orientation(), truth) * degrees);
        worst.all = std::max(worst.all, angle_between(filter.orientation(), truth) * degrees);
        const PoseState ahead = predicted(filter.state(), 0.02);
        worst.predicted =
            std::max(worst.predicted, angle_between(quaternion(ahead.pose.orientation), motion.orientation(t + 0.02)) * degrees);
    }
    return worst;
}

void record(const char* setting, const Worst& worst) {
    entoptic::testing::ledger("drivers.head_filter", setting, "tilt worst deg", worst.tilt);
    entoptic::testing::ledger("drivers.head_filter", setting, "orientation worst deg", worst.all);
    entoptic::testing::ledger("drivers.head_filter", setting, "predicted 20 ms worst deg", worst.predicted);
}

TEST(HeadFilter, AtRestItIsUprightAndKnowsItsBiases) {
    HeadFilter filter;
    SensorErrors errors;
    errors.rate_bias = {0.02, -0.03, 0.015};
    const Worst worst = follow(filter, {}, errors, 5, 60);
    EXPECT_LT(worst.tilt, 0.1);
    EXPECT_LT(worst.all, 1.0);
    EXPECT_LT((filter.rate_bias() - errors.rate_bias).norm(), 5e-4);
    record("at rest with 1.7 deg/s of bias", worst);
}

TEST(HeadFilter, FollowsALookAround) {
    HeadMotion motion{1.0, 0.5, 0.2};
    HeadFilter filter;
    SensorErrors errors;
    errors.rate_bias = {0.004, -0.003, 0.002};
    follow(filter, {}, errors, 10, 3);
    HeadMotion later = motion;
    const Worst worst = [&] {
        Worst w;
        for (int n = 0; n < 57'000; ++n) {
            const double t = n * 1e-3;
            InertialSample s = inertial_sample(later, errors, t, Vector3d::Zero(), 4 * ns_per_s);
            filter.inertial(s);
            const Quaterniond truth = later.orientation(t);
            w.tilt = std::max(w.tilt, tilt_between(filter.orientation(), truth) * degrees);
            w.all = std::max(w.all, angle_between(filter.orientation(), truth) * degrees);
            w.predicted = std::max(
                w.predicted,
                angle_between(quaternion(predicted(filter.state(), 0.02).pose.orientation), later.orientation(t + 0.02)) * degrees);
        }
        return w;
    }();
    EXPECT_LT(worst.tilt, 0.5);
    EXPECT_LT(worst.all, 1.5);  // a minute without anything that holds the heading
    EXPECT_LT(worst.predicted, 2.5);
    record("look around for a minute", worst);
}

// 600 degrees a second.
TEST(HeadFilter, FastRotation) {
    HeadMotion motion{1.2, 0.3, 0.2, 1.4};
    HeadFilter filter;
    const Worst worst = follow(filter, motion, {}, 1, 20);
    EXPECT_LT(worst.tilt, 0.7);
    EXPECT_LT(worst.all, 1.5);
    record("fast rotation 600 deg/s", worst);
}

// Straight up and straight down: where Euler angles lose an axis.
TEST(HeadFilter, Gimbal) {
    HeadMotion motion{1.0, 0.25, 0.3};
    motion.pitch_offset = std::numbers::pi / 2;
    HeadFilter filter;
    const Worst worst = follow(filter, motion, {}, 1, 30);
    EXPECT_LT(worst.tilt, 0.5);
    EXPECT_LT(worst.all, 1.0);
    record("gimbal: looking straight up", worst);
}

TEST(HeadFilter, ABiasThatJumpsIsLearntAtRest) {
    HeadFilter filter;
    SensorErrors errors;
    follow(filter, {}, errors, 100, 10);
    errors.rate_bias = {0.05, 0.05, -0.05};
    const Worst worst = follow(filter, {}, errors, 12, 20, 10);
    EXPECT_LT((filter.rate_bias() - errors.rate_bias).norm(), 2e-3);
    EXPECT_LT(worst.tilt, 0.5);
    record("bias jump of 5 deg/s at rest", worst);
    EXPECT_LT(worst.all, 6);  // the half second until it is believed is lost for the heading
}

// Walking, nodding: the head's own accelerations must not tip the world.
TEST(HeadFilter, AccelerationsDoNotTipTheWorld) {
    HeadMotion motion{0.5, 0.3, 0.1};
    motion.sway_m = 0.1;
    motion.sway_hz = 0.8;
    HeadFilter filter;
    const Worst worst = follow(filter, motion, {}, 5, 40);
    EXPECT_LT(worst.tilt, 2.0);
    record("walking with 0.1 m of sway", worst);
}

TEST(HeadFilter, PositionIsTheNecksAndNotTracked) {
    HeadMotion motion;
    motion.pitch_offset = -0.8;  // looks down
    HeadFilter filter;
    EXPECT_FALSE(filter.state().orientation_valid);
    follow(filter, motion, {}, 100, 3);
    const PoseState state = filter.state();
    EXPECT_TRUE(state.orientation_tracked);
    EXPECT_TRUE(state.position_valid);
    EXPECT_FALSE(state.position_tracked);
    // The eyes go forward and down about the neck: pivot at (0, 1.525, 0.08), then (0, 0.075, -0.08) turned by -0.8 rad about x.
    const double c = std::cos(0.8), s = std::sin(0.8);
    EXPECT_NEAR(double(state.pose.position.y), 1.6 - 0.075 + 0.075 * c - 0.08 * s, 3e-3);
    EXPECT_NEAR(double(state.pose.position.z), 0.08 - 0.075 * s - 0.08 * c, 3e-3);
}

TEST(HeadFilter, StartsUprightFromAnyAttitude) {
    for (const Vector3d& up :
         {Vector3d(0, 9.8, 0), Vector3d(9.8, 0, 0), Vector3d(0, -9.8, 0), Vector3d(0.1, -9.79, 0.1), Vector3d(0, 0, 9.8)}) {
        HeadFilter filter;
        filter.inertial({1, up, Vector3d::Zero()});
        EXPECT_NEAR((filter.orientation() * up.normalized()).y(), 1, 1e-9);
        EXPECT_TRUE(std::isfinite(filter.orientation().w()));
    }
}

TEST(HeadFilter, NonsenseAndRepeatedTimesChangeNothing) {
    HeadFilter filter;
    follow(filter, {}, {}, 100, 1);
    const Quaterniond before = filter.orientation();
    filter.inertial({filter.time(), Vector3d(1, 2, 3), Vector3d(9, 9, 9)});
    filter.inertial({filter.time() - 5, Vector3d(1, 2, 3), Vector3d(9, 9, 9)});
    filter.inertial({filter.time() + 5, Vector3d(std::nan(""), 2, 3), Vector3d(9, 9, 9)});
    EXPECT_EQ(angle_between(before, filter.orientation()), 0);
}

TEST(HeadFilter, AGapBeginsAnewWithTheOldHeading) {
    HeadMotion motion;
    motion.yaw = 0.7;
    motion.yaw_hz = 1 / 8.0;
    HeadFilter filter;
    follow(filter, motion, {}, 100, 2);
    const Quaterniond before = filter.orientation();
    InertialSample late = inertial_sample({}, {}, 60, Vector3d::Zero());
    filter.inertial(late);
    const Vector3d a = before * -Vector3d::UnitZ(), b = filter.orientation() * -Vector3d::UnitZ();
    EXPECT_NEAR(std::atan2(a.x(), -a.z()), std::atan2(b.x(), -b.z()), 0.01);
}

TEST(PoseHistory, InterpolatesPredictsAndGrowsStale) {
    PoseHistory history(4);
    EXPECT_FALSE(history.at(5).orientation_valid);
    for (int i = 1; i <= 6; ++i) {
        PoseState s;
        s.orientation_valid = s.orientation_tracked = s.velocity_valid = true;
        s.pose.orientation = glm::angleAxis(0.1f * static_cast<float>(i), glm::vec3(0, 1, 0));
        s.angular_velocity = {0, 100, 0};  // 0.1 rad a ms
        history.push(i * 1'000'000, s);
    }
    history.push(2'000'000, {});  // too old: left out
    const auto yaw = [](const PoseState& s) { return 2 * std::atan2(s.pose.orientation.y, s.pose.orientation.w); };
    EXPECT_NEAR(yaw(history.at(4'500'000)), 0.45, 1e-5);
    EXPECT_NEAR(yaw(history.at(0)), 0.3, 1e-5);          // the oldest of four
    EXPECT_NEAR(yaw(history.at(7'000'000)), 0.7, 1e-5);  // predicted
    EXPECT_TRUE(history.at(100'000'000).orientation_tracked);
    EXPECT_FALSE(history.at(200'000'000).orientation_tracked);
    EXPECT_TRUE(history.at(200'000'000).orientation_valid);
}

}  // namespace
}  // namespace entoptic::drivers
