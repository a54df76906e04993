#include "drivers/fusion/pose_history.h"

#include <algorithm>

namespace entoptic::drivers {

namespace {

PoseState between(const PoseState& a, const PoseState& b, float t) {
    PoseState out = b;
    out.pose.orientation = glm::slerp(a.pose.orientation, b.pose.orientation, t);
    out.pose.position = glm::mix(a.pose.position, b.pose.position, t);
    out.linear_velocity = glm::mix(a.linear_velocity, b.linear_velocity, t);
    out.angular_velocity = glm::mix(a.angular_velocity, b.angular_velocity, t);
    return out;
}

}  // namespace

PoseState predicted(const PoseState& state, double seconds) {
    PoseState out = state;
    const glm::vec3 turn = state.angular_velocity * static_cast<float>(seconds);
    const float angle = glm::length(turn);
    if (angle > 1e-9f) out.pose.orientation = glm::normalize(glm::angleAxis(angle, turn / angle) * state.pose.orientation);
    out.pose.position += state.linear_velocity * static_cast<float>(seconds);
    return out;
}

PoseHistory::PoseHistory(std::size_t capacity) : ring_(std::max<std::size_t>(capacity, 2)) {}

void PoseHistory::push(TimeNs time, const PoseState& state) {
    const std::lock_guard lock(mutex_);
    if (count_ > 0 && time <= entry(count_ - 1).time) return;
    if (count_ == ring_.size())
        first_ = (first_ + 1) % ring_.size();
    else
        ++count_;
    ring_[(first_ + count_ - 1) % ring_.size()] = {time, state};
}

PoseState PoseHistory::at(TimeNs time) const {
    const std::lock_guard lock(mutex_);
    if (count_ == 0) return {};
    const Entry& newest = entry(count_ - 1);
    if (time >= newest.time) {
        PoseState out = predicted(newest.state, seconds(std::min(time - newest.time, max_prediction)));
        if (time - newest.time > stale_after) {
            out.orientation_tracked = out.position_tracked = out.velocity_valid = false;
            out.linear_velocity = out.angular_velocity = {};
        }
        return out;
    }
    if (time <= entry(0).time) return entry(0).state;
    std::size_t low = 0, high = count_ - 1;  // entry(low).time < time <= entry(high).time
    while (high - low > 1) {
        const std::size_t middle = (low + high) / 2;
        (entry(middle).time < time ? low : high) = middle;
    }
    const double span = static_cast<double>(entry(high).time - entry(low).time);
    return between(entry(low).state, entry(high).state, static_cast<float>(static_cast<double>(time - entry(low).time) / span));
}

}  // namespace entoptic::drivers
