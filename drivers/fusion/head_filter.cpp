#include "drivers/fusion/head_filter.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace entoptic::drivers {

namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr DurationNs longest_gap = ns_per_s, tracked_after_bearing = 100'000'000, history_length = 120'000'000;
constexpr double believed_sigmas = 5;
constexpr int gravity_samples = 10, still_samples = 500;
// A head on a table: nothing but the sensors' noise (12 and 25 counts). choice: three times that; breathing alone is above it.
constexpr double still_rate_sd = 8e-3, still_acc_sd = 0.08;
constexpr double still_rate_limit = 0.15;  // rad/s: above this it is a turn at constant speed, not a bias

Matrix3d cross_matrix(const Vector3d& v) {
    Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

Quaterniond exponential(const Vector3d& rotation) {
    const double angle = rotation.norm();
    if (angle < 1e-12) return Quaterniond(1, rotation.x() / 2, rotation.y() / 2, rotation.z() / 2).normalized();
    return Quaterniond(Eigen::AngleAxisd(angle, rotation / angle));
}

glm::vec3 to_glm(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
glm::quat to_glm(const Quaterniond& q) {
    return glm::quat(static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()));
}

}  // namespace

HeadFilter::HeadFilter(const HeadFilterParameters& parameters) : k_(parameters) {
    v_.setZero(), p_.setZero(), rate_bias_.setZero(), acc_bias_.setZero(), rate_.setZero(), neck_.setZero();
    gravity_sum_.setZero();
    still_rate_.setZero(), still_rate_squares_.setZero(), still_acc_.setZero(), still_acc_squares_.setZero();
    covariance_.setZero();
}

Vector3d HeadFilter::head_position() const {
    if (tracks_position_) return p_ - q_ * k_.sensor_in_head;
    return neck_ + q_ * k_.eyes_from_neck;
}

Vector3d HeadFilter::velocity() const {
    if (tracks_position_) return v_ - q_ * rate_.cross(k_.sensor_in_head);
    return q_ * rate_.cross(k_.eyes_from_neck);
}

double HeadFilter::orientation_sd() const { return std::sqrt(covariance_.diagonal().segment<3>(theta).maxCoeff()); }
double HeadFilter::position_sd() const { return std::sqrt(covariance_.diagonal().segment<3>(pos).maxCoeff()); }

// ---- Inertial ---------------------------------------------------------------------------------------------------------------------------

// Upright as gravity says, looking along -z: the turn from "up as measured" to y has no part about y.
void HeadFilter::start(const InertialSample& sample) {
    started_ = true;
    time_ = sample.time;
    q_ = Quaterniond::FromTwoVectors(sample.acceleration, Vector3d::UnitY());
    const Vector3d forward = q_ * -Vector3d::UnitZ();
    if (std::hypot(forward.x(), forward.z()) > 1e-3)
        q_ = Quaterniond(Eigen::AngleAxisd(std::atan2(forward.x(), -forward.z()), Vector3d::UnitY())) * q_;
    rate_.setZero();
    v_.setZero();
    covariance_.setZero();
    covariance_.diagonal().segment<3>(theta).setConstant(0.05 * 0.05);
    covariance_.diagonal().segment<3>(rate_b).setConstant(k_.initial_rate_bias * k_.initial_rate_bias);
    covariance_.diagonal().segment<3>(acc_b).setConstant(k_.initial_acceleration_bias * k_.initial_acceleration_bias);
    tracks_position_ = false;
    neck_ = Vector3d(0, k_.start_height, 0) - k_.eyes_from_neck;
    history_.clear();
}

void HeadFilter::inertial(const InertialSample& sample) {
    if (!sample.acceleration.allFinite() || !sample.rate.allFinite()) return;
    if (!started_) {
        if (sample.acceleration.norm() > 0.5 * k_.gravity) start(sample);
        return;
    }
    if (sample.time <= time_) return;
    if (sample.time - time_ > longest_gap) {
        const Vector3d bias = rate_bias_;
        const Quaterniond heading = q_;
        start(sample);
        rate_bias_ = bias;  // the sensor is the same
        const Vector3d before = heading * -Vector3d::UnitZ(), after = q_ * -Vector3d::UnitZ();
        const double turn = std::atan2(after.x(), -after.z()) - std::atan2(before.x(), -before.z());
        q_ = Quaterniond(Eigen::AngleAxisd(turn, Vector3d::UnitY())) * q_;  // keeps its heading: better than none
        return;
    }
    const double dt = seconds(sample.time - time_);
    propagate(sample, dt);
    time_ = sample.time;
    watch_stillness(sample);
    gravity_sum_ += sample.acceleration - acc_bias_;
    if (++gravity_count_ == gravity_samples) gravity_update();
    remember();
}

void HeadFilter::propagate(const InertialSample& sample, double dt) {
    const Vector3d rate = sample.rate - rate_bias_, acceleration = sample.acceleration - acc_bias_;
    const Vector3d mean_rate = dt < 0.01 ? Vector3d((rate + rate_) / 2) : rate;  // the trapezium halves the error of a turning axis
    rate_ = rate;
    const Matrix3d before = q_.toRotationMatrix();
    const Quaterniond middle = q_ * exponential(mean_rate * dt / 2);
    q_ = (q_ * exponential(mean_rate * dt)).normalized();
    if (tracks_position_) {
        const Vector3d moved = middle * acceleration - Vector3d(0, k_.gravity, 0);
        p_ += v_ * dt + moved * dt * dt / 2;
        v_ += moved * dt;
    }
    Matrix f = Matrix::Identity();
    f.block<3, 3>(theta, theta) -= cross_matrix(mean_rate * dt);
    f.block<3, 3>(theta, rate_b) = -Matrix3d::Identity() * dt;
    if (tracks_position_) {
        f.block<3, 3>(vel, theta) = -before * cross_matrix(acceleration) * dt;
        f.block<3, 3>(vel, acc_b) = -before * dt;
        f.block<3, 3>(pos, vel) = Matrix3d::Identity() * dt;
    }
    covariance_ = f * covariance_ * f.transpose();
    const auto add = [&](int at, double density) { covariance_.diagonal().segment<3>(at).array() += density * density * dt; };
    add(theta, k_.rate_noise);
    add(rate_b, k_.rate_bias_walk);
    if (tracks_position_) {
        add(vel, k_.acceleration_noise);
        add(acc_b, k_.acceleration_bias_walk);
    }
}

// Up as the accelerometer feels it against up as the filter has it. Only the length of what it feels tells gravity from the head's own
// motion, so the doubt grows with the difference.
void HeadFilter::gravity_update() {
    const Vector3d felt = gravity_sum_ / gravity_count_;
    gravity_sum_.setZero();
    gravity_count_ = 0;
    if (tracks_position_) return;  // there the acceleration is a part of the motion, and bearings hold the tilt
    const double difference = std::abs(felt.norm() - k_.gravity);
    if (difference > 0.3 * k_.gravity) return;
    const Vector3d expected = q_.conjugate() * Vector3d::UnitY(), measured = felt.normalized();
    const double sd = k_.gravity_direction_sd + difference + 0.1 * rate_.norm();
    // R^T up with q exp(e): expected + [expected]x e.
    const Matrix3d jacobian = cross_matrix(expected);
    for (int axis = 0; axis < 3; ++axis) {
        Row h = Row::Zero();
        h.segment<3>(theta) = jacobian.row(axis);
        const Vector3d now = q_.conjugate() * Vector3d::UnitY();
        correct(h, measured[axis] - now[axis], sd * sd);
    }
}

void HeadFilter::watch_stillness(const InertialSample& sample) {
    still_rate_ += sample.rate;
    still_rate_squares_ += sample.rate.cwiseProduct(sample.rate);
    still_acc_ += sample.acceleration;
    still_acc_squares_ += sample.acceleration.cwiseProduct(sample.acceleration);
    if (++still_count_ < still_samples) return;
    const double n = still_count_;
    const Vector3d rate = still_rate_ / n, acceleration = still_acc_ / n;
    const double rate_variance = (still_rate_squares_ / n - rate.cwiseProduct(rate)).maxCoeff();
    const double acc_variance = (still_acc_squares_ / n - acceleration.cwiseProduct(acceleration)).maxCoeff();
    still_rate_.setZero(), still_rate_squares_.setZero(), still_acc_.setZero(), still_acc_squares_.setZero();
    still_count_ = 0;
    if (rate_variance < still_rate_sd * still_rate_sd && acc_variance < still_acc_sd * still_acc_sd && rate.norm() < still_rate_limit)
        still_update(rate);
}

// Nothing moves: what the gyroscope says is its bias. The only thing that sees the bias of the heading.
void HeadFilter::still_update(const Vector3d& mean_rate) {
    const double sd = k_.rate_noise * std::sqrt(1000.0) / std::sqrt(double(still_samples)) + 3e-4;
    const Vector3d off = mean_rate - rate_bias_;
    const double expected = std::sqrt(covariance_.diagonal().segment<3>(rate_b).maxCoeff() + sd * sd);
    if (off.norm() > believed_sigmas * expected) {  // the bias jumped: a bump, a change of temperature; it has turned the head since
        covariance_.diagonal().segment<3>(rate_b).array() += off.squaredNorm();
        covariance_.diagonal().segment<3>(theta).array() += off.squaredNorm() * 0.25;
    }
    for (int axis = 0; axis < 3; ++axis) {
        Row h = Row::Zero();
        h[rate_b + axis] = 1;
        correct(h, mean_rate[axis] - rate_bias_[axis], sd * sd);
    }
}

// ---- Corrections -----------------------------------------------------------------------------------------------------------------------

void HeadFilter::correct(const Row& h, double residual, double variance) {
    const Vector ph = covariance_ * h.transpose();
    const double s = h.dot(ph) + variance;
    const Vector gain = ph / s;
    covariance_ -= gain * ph.transpose();
    covariance_ = (covariance_ + covariance_.transpose().eval()) * 0.5;
    inject(gain * residual);
}

void HeadFilter::inject(const Vector& error) {
    q_ = (q_ * exponential(error.segment<3>(theta))).normalized();
    if (tracks_position_) {
        v_ += error.segment<3>(vel);
        p_ += error.segment<3>(pos);
        acc_bias_ += error.segment<3>(acc_b);
    }
    rate_bias_ += error.segment<3>(rate_b);
}

void HeadFilter::remember() {
    history_.push_back({time_, q_, head_position()});
    while (time_ - history_.front().time > history_length) history_.pop_front();
}

std::optional<HeadFilter::Past> HeadFilter::past_at(TimeNs time) const {
    if (history_.empty() || time < history_.front().time || time > time_ + 5'000'000) return std::nullopt;
    const auto after = std::lower_bound(history_.begin(), history_.end(), time, [](const Past& past, TimeNs t) { return past.time < t; });
    if (after == history_.end()) return history_.back();
    if (after == history_.begin() || after->time == time) return *after;
    const Past& before = *(after - 1);
    const double part = double(time - before.time) / double(after->time - before.time);
    return Past{time, before.q.slerp(part, after->q), before.head + (after->head - before.head) * part};
}

void HeadFilter::start_position(const PoseFix& fix) {
    if (!started_) return;
    const Quaterniond own = q_;
    const Vector3d before = head_position();
    forget_position();
    take_orientation(fix);
    // The way here stays what it was, seen from the new place: bearings of the last milliseconds are still to come.
    const Quaterniond turned = q_ * own.conjugate();
    for (Past& past : history_) {
        past.q = (turned * past.q).normalized();
        past.head = fix.position + turned * (past.head - before);
    }
    p_ = fix.position + q_ * k_.sensor_in_head;
    v_ = fix.velocity + q_ * rate_.cross(k_.sensor_in_head);
    covariance_.diagonal().segment<3>(pos).setConstant(fix.position_sd * fix.position_sd);
    covariance_.diagonal().segment<3>(vel).setConstant(0.25);  // (0.5 m/s)²: a fix knows little of it
    covariance_.diagonal().segment<3>(acc_b).setConstant(k_.initial_acceleration_bias * k_.initial_acceleration_bias);
    tracks_position_ = true;
    last_bearing_ = time_;
}

// Its own is better than a fix's, as long as both agree; else the fix's, and nothing that was known depends on it.
void HeadFilter::take_orientation(const PoseFix& fix) {
    const double doubt = orientation_sd() + fix.orientation_sd;
    if (q_.angularDistance(fix.world_from_head) < believed_sigmas * doubt) return;
    q_ = fix.world_from_head.normalized();
    covariance_.middleRows<3>(theta).setZero();
    covariance_.middleCols<3>(theta).setZero();
    covariance_.diagonal().segment<3>(theta).setConstant(fix.orientation_sd * fix.orientation_sd);
}

bool HeadFilter::bearing(TimeNs time, double measured, double sd, const Model& model) {
    if (!tracks_position_) return false;
    const auto past = past_at(time);
    if (!past) return false;
    const double residual = measured - model(past->q, past->head);
    if (!std::isfinite(residual)) return false;
    Row h = Row::Zero();
    constexpr double step = 1e-6;
    const Vector3d sensor = past->head + past->q * k_.sensor_in_head;
    for (int axis = 0; axis < 3; ++axis) {
        const Vector3d e = Vector3d::Unit(axis) * step;
        const auto turned = [&](const Vector3d& by) {  // about the accelerometer, whose position is the state
            const Quaterniond q = past->q * exponential(by);
            return model(q, sensor - q * k_.sensor_in_head);
        };
        h[theta + axis] = (turned(e) - turned(-e)) / (2 * step);
        h[pos + axis] = (model(past->q, past->head + e) - model(past->q, past->head - e)) / (2 * step);
    }
    // What is corrected is the state of now; at the bearing's time it was `age` behind.
    const double age = seconds(time_ - time);
    h.segment<3>(vel) = -age * h.segment<3>(pos);
    h.segment<3>(rate_b) = age * h.segment<3>(theta);
    if (!h.allFinite()) return false;
    const double variance = (h * covariance_ * h.transpose()).value() + sd * sd;
    if (residual * residual > believed_sigmas * believed_sigmas * variance) return false;
    const Vector3d head_before = head_position(), v_before = v_;
    const Quaterniond q_before = q_;
    correct(h, residual, sd * sd);
    last_bearing_ = std::max(last_bearing_, time);
    // Older poses were as wrong as this one: later bearings from them must not correct the same error again.
    const Vector3d moved = head_position() - head_before, faster = v_ - v_before;
    const Quaterniond turned = q_before.conjugate() * q_;
    for (Past& p : history_) {
        p.q = (p.q * turned).normalized();
        p.head += moved - faster * seconds(time_ - p.time);
    }
    return true;
}

void HeadFilter::forget_position() {
    for (const int at : {vel, pos, acc_b}) {
        covariance_.middleRows<3>(at).setZero();
        covariance_.middleCols<3>(at).setZero();
    }
    v_.setZero();
    acc_bias_.setZero();
}

void HeadFilter::stop_position() {
    if (!tracks_position_) return;
    neck_ = head_position() - q_ * k_.eyes_from_neck;
    forget_position();
    tracks_position_ = false;
}

PoseState HeadFilter::state() const {
    PoseState out;
    if (!started_) return out;
    out.pose = {to_glm(q_), to_glm(head_position())};
    out.angular_velocity = to_glm(Vector3d(q_ * rate_));
    out.linear_velocity = to_glm(velocity());
    out.orientation_valid = out.position_valid = out.velocity_valid = true;
    out.orientation_tracked = true;
    out.position_tracked = tracks_position_ && time_ - last_bearing_ <= tracked_after_bearing;
    return out;
}

}  // namespace entoptic::drivers
