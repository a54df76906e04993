// For tests: a head whose motion is known exactly, and the sensors on it with noise and bias.
#pragma once

#include "base/noise.h"
#include "base/time.h"
#include "drivers/fusion/head_filter.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace entoptic::drivers::testing {

// Sums of sines, so that every derivative exists; zero speed at time 0 when `ease` (s) is above 0.
struct HeadMotion {
    double yaw = 0, pitch = 0, roll = 0;  // amplitudes, rad
    double yaw_hz = 0.5, pitch_hz = 0.37, roll_hz = 0.23;
    double pitch_offset = 0;           // rad
    double sway_m = 0, sway_hz = 0.3;  // of the position, each axis at its own frequency
    double ease = 1;

    double amount(double t) const { return ease <= 0 ? 1 : t <= 0 ? 0 : t >= ease ? 1 : t * t * (3 - 2 * t / ease) / (ease * ease); }
    Eigen::Quaterniond orientation(double t) const {
        const double a = amount(t), turn = 2 * std::numbers::pi;
        return Eigen::Quaterniond(Eigen::AngleAxisd(a * yaw * std::sin(turn * yaw_hz * t), Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(a * (pitch_offset + pitch * std::sin(turn * pitch_hz * t)), Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(a * roll * std::sin(turn * roll_hz * t), Eigen::Vector3d::UnitZ()));
    }
    Eigen::Vector3d position(double t) const {
        const double a = amount(t) * sway_m, w = 2 * std::numbers::pi * sway_hz;
        return {a * std::sin(w * t), 1.6 + 0.5 * a * std::sin(1.3 * w * t), a * std::sin(0.7 * w * t + 0.5) - a * std::sin(0.5)};
    }
    // Body rates, rad/s, by central difference of the rotation: exact to 1e-8.
    Eigen::Vector3d rate(double t) const {
        constexpr double h = 1e-4;
        const Eigen::AngleAxisd turn(orientation(t - h).conjugate() * orientation(t + h));
        return turn.axis() * turn.angle() / (2 * h);
    }
    // What an accelerometer at `sensor` (head axes, m) feels, m/s².
    Eigen::Vector3d felt(double t, const Eigen::Vector3d& sensor) const {
        constexpr double h = 1e-3;
        const auto at = [&](double s) { return Eigen::Vector3d(position(s) + orientation(s) * sensor); };
        const Eigen::Vector3d acceleration = (at(t + h) - 2 * at(t) + at(t - h)) / (h * h);
        return orientation(t).conjugate() * (acceleration + Eigen::Vector3d(0, 9.80665, 0));
    }
};

// Noise as the recorded Vive has it at rest (facts/devices.md 1.2): 12 counts of 8.7266/32768 rad/s, 25 counts of 39.2266/32768 m/s².
struct SensorErrors {
    double rate_sd = 12 * 8.7266 / 32768, acceleration_sd = 25 * 39.2266 / 32768;
    Eigen::Vector3d rate_bias{0, 0, 0}, acceleration_bias{0, 0, 0};
    std::uint64_t seed = 1;
};

inline InertialSample inertial_sample(const HeadMotion& motion, const SensorErrors& errors, double t, const Eigen::Vector3d& sensor,
                                      TimeNs start = ns_per_s) {
    const auto noise = [&](std::uint64_t k) { return normal(errors.seed, static_cast<std::uint64_t>(t * 1e6) * 8 + k); };
    InertialSample s;
    s.time = start + nanoseconds(t);
    s.rate = motion.rate(t) + errors.rate_bias + errors.rate_sd * Eigen::Vector3d(noise(0), noise(1), noise(2));
    s.acceleration =
        motion.felt(t, sensor) + errors.acceleration_bias + errors.acceleration_sd * Eigen::Vector3d(noise(3), noise(4), noise(5));
    return s;
}

inline double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) { return a.angularDistance(b); }
// Of the up directions only: what gravity can tell.
inline double tilt_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
    const Eigen::Vector3d ua = a.conjugate() * Eigen::Vector3d::UnitY(), ub = b.conjugate() * Eigen::Vector3d::UnitY();
    return std::atan2(ua.cross(ub).norm(), ua.dot(ub));
}

}  // namespace entoptic::drivers::testing
