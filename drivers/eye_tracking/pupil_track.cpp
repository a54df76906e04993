#include "drivers/eye_tracking/pupil_track.h"

#include <algorithm>
#include <cmath>

namespace entoptic::drivers {

namespace {

constexpr DurationNs largest_step = milliseconds(5);
constexpr int most_steps = 4000;  // 20 s: by then the diameter is the model's

}  // namespace

// The target held or relaxing over the step; half of the relaxation before the low-pass and half after keeps steps of any size alike.
void PupilTrack::step(const PupilFilterParameters& parameters, DurationNs duration) {
    const DurationNs age = time_ - newest_arrival();
    if (!holding_ && age >= parameters.fresh) {
        holding_ = true;
        target_mm_ = diameter_mm_;  // what came last before a loss is the least to be trusted
    }
    const double dt = seconds(duration);
    const double half = age >= parameters.hold ? std::exp(-0.5 * dt / parameters.relax_tau_s) : 1;
    target_mm_ = parameters.model_mm + (target_mm_ - parameters.model_mm) * half;
    const double change = (target_mm_ - diameter_mm_) * -std::expm1(-dt / parameters.low_pass_s);
    diameter_mm_ += std::clamp(change, -parameters.constriction_mm_s * dt, parameters.dilation_mm_s * dt);
    target_mm_ = parameters.model_mm + (target_mm_ - parameters.model_mm) * half;
    time_ += duration;
}

void PupilTrack::advance(const PupilFilterParameters& parameters, TimeNs time) {
    if (!seen_) {
        time_ = std::max(time_, time);
        return;
    }
    for (int i = 0; time_ < time; ++i) {
        if (i == most_steps) {
            diameter_mm_ = target_mm_ = parameters.model_mm;
            time_ = time;
            return;
        }
        DurationNs dt = std::min(largest_step, time - time_);
        for (const TimeNs border : {newest_arrival() + parameters.fresh, newest_arrival() + parameters.hold}) {
            if (border > time_) dt = std::min(dt, border - time_);
        }
        step(parameters, dt);
    }
}

void PupilTrack::add(const PupilFilterParameters& parameters, int eye, double diameter_mm) {
    const auto e = static_cast<std::size_t>(eye);
    known_[e] = true;
    arrival_[e] = time_;
    measured_mm_[e] = diameter_mm;
    const std::size_t other = 1 - e;
    const bool both = known_[other] && time_ - arrival_[other] <= parameters.fresh;
    target_mm_ = both ? 0.5 * (diameter_mm + measured_mm_[other]) : diameter_mm;
    if (!seen_) {
        diameter_mm_ = target_mm_;
        arrival_[other] = time_;
    }
    seen_ = true;
    holding_ = false;
    before_.add(time_, diameter_mm_);
}

void PupilTrack::roll_back(TimeNs time) {
    if (const auto* entry = before_.newest_until(time)) target_mm_ = entry->value;
}

}  // namespace entoptic::drivers
