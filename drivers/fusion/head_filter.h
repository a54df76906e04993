// Where a head is, from its gyroscope, accelerometer and, when there are any, bearings to fixed stations: an error-state Kalman filter
// (Solà 2017, *Quaternion kinematics for the error-state Kalman filter*) with orientation, velocity, position and both sensors' biases.
// Without bearings the position comes from a neck model, and says so. World: y up against gravity; heading and floor are where it began.
// Not thread-safe.
#pragma once

#include "base/time.h"
#include "interfaces/sources.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <deque>
#include <functional>
#include <optional>

namespace entoptic::drivers {

struct HeadFilterParameters {
    double gravity = 9.80665;  // m/s²
    // Noise of the Vive's sensor at rest is 12 and 25 counts: 3e-3 rad/s and 0.03 m/s² a sample at 1 kHz. Taken three times as large, for
    // scale errors and vibration.
    double rate_noise = 3e-4;                // rad/s per sqrt(Hz)
    double acceleration_noise = 3e-3;        // m/s² per sqrt(Hz)
    double rate_bias_walk = 3e-5;            // rad/s per sqrt(s); choice: typical consumer MEMS
    double acceleration_bias_walk = 3e-4;    // m/s² per sqrt(s); choice
    double initial_rate_bias = 0.02;         // rad/s, 1 sigma; choice: temperature moves it by degrees a second
    double initial_acceleration_bias = 0.1;  // m/s²
    double gravity_direction_sd =
        0.3;  // rad, of one gravity update (every 10 ms): a walking head's own acceleration tips what it feels for a second
    double start_height = 1.6;  // m, of the eyes above the floor: standing; choice
    // From the neck's pivot to the point between the eyes, head axes, m. Source: Google's Cardboard SDK.
    Eigen::Vector3d eyes_from_neck{0, 0.075, -0.08};
    Eigen::Vector3d sensor_in_head{0, 0, 0};  // where the accelerometer sits, m
};

struct InertialSample {
    TimeNs time = 0;
    Eigen::Vector3d acceleration;  // m/s², head axes; at rest +g along up
    Eigen::Vector3d rate;          // rad/s, head axes
};

// A pose of the head measured by something else; replaces the filter's own position, corrects its orientation.
struct PoseFix {
    Eigen::Quaterniond world_from_head;
    Eigen::Vector3d position;                            // of the head, m
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s, world
    double position_sd = 0.01;                           // m
    double orientation_sd = 0.02;                        // rad
};

class HeadFilter {
public:
    explicit HeadFilter(const HeadFilterParameters& parameters = {});

    // Samples in the order of their times. A gap of more than a second starts the orientation anew.
    void inertial(const InertialSample& sample);

    // Begins to track the position. Only after the first inertial sample.
    void start_position(const PoseFix& fix);
    // One scalar that depends on the pose: `model(world_from_head, position)` should be `measured` (rad), with noise `sd`, at `time`, up to
    // 100 ms in the past. False when it is too far off to be believed (more than 5 sigma) or there is no position to correct.
    using Model = std::function<double(const Eigen::Quaterniond&, const Eigen::Vector3d&)>;
    bool bearing(TimeNs time, double measured, double sd, const Model& model);
    // Where the head was, as it is known now; up to 100 ms back.
    struct Past {
        TimeNs time = 0;
        Eigen::Quaterniond q = Eigen::Quaterniond::Identity();  // world from head
        Eigen::Vector3d head = Eigen::Vector3d::Zero();         // m
    };
    std::optional<Past> past_at(TimeNs time) const;
    // Back to the neck model, from where the head is.
    void stop_position();
    bool tracks_position() const { return tracks_position_; }

    bool started() const { return started_; }
    TimeNs time() const { return time_; }
    // Now; flags as described in interfaces/sources.h. Position counts as tracked for 100 ms after the last bearing.
    PoseState state() const;
    Eigen::Quaterniond orientation() const { return q_; }
    Eigen::Vector3d head_position() const;
    Eigen::Vector3d velocity() const;  // of the head, m/s, world
    Eigen::Vector3d rate_bias() const { return rate_bias_; }
    double orientation_sd() const;  // rad, largest of the three axes
    double position_sd() const;     // m

private:
    static constexpr int size = 15, theta = 0, vel = 3, pos = 6, rate_b = 9, acc_b = 12;
    using Matrix = Eigen::Matrix<double, size, size>;
    using Row = Eigen::Matrix<double, 1, size>;
    using Vector = Eigen::Matrix<double, size, 1>;
    void start(const InertialSample& sample);
    void propagate(const InertialSample& sample, double dt);
    void watch_stillness(const InertialSample& sample);
    void gravity_update();
    void still_update(const Eigen::Vector3d& mean_rate);
    void correct(const Row& h, double residual, double variance);
    void inject(const Vector& error);
    void forget_position();
    void take_orientation(const PoseFix& fix);
    void remember();

    HeadFilterParameters k_;
    bool started_ = false, tracks_position_ = false;
    TimeNs time_ = 0, last_bearing_ = 0;
    Eigen::Quaterniond q_ = Eigen::Quaterniond::Identity();  // world from head
    Eigen::Vector3d v_, p_, rate_bias_, acc_bias_;           // of the accelerometer, world
    Eigen::Vector3d rate_, neck_;                            // rate: bias removed, head axes. neck: pivot in the world
    Matrix covariance_;
    std::deque<Past> history_;  // 120 ms
    // For gravity: a mean over 10 ms. For stillness: sums over half a second.
    Eigen::Vector3d gravity_sum_;
    int gravity_count_ = 0;
    Eigen::Vector3d still_rate_, still_rate_squares_, still_acc_, still_acc_squares_;
    int still_count_ = 0;
};

}  // namespace entoptic::drivers
