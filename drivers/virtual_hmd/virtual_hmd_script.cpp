#include "drivers/virtual_hmd/virtual_hmd_script.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace entoptic::drivers {

namespace {

constexpr double radians_per_degree = 0.017453292519943295;

glm::dquat rotation(double angle_deg, glm::dvec3 axis) { return glm::angleAxis(angle_deg * radians_per_degree, axis); }

// Shared by head and controllers. `position_time` and `orientation_time` differ where one is held.
PoseState pose_state(const Channel<3>& position, double position_time, const Channel<3>& orientation, double orientation_time) {
    const ChannelValue<3> p = position.at(position_time), o = orientation.at(orientation_time);
    PoseState state;
    state.pose.position = glm::vec3(p.value[0], p.value[1], p.value[2]);
    state.pose.orientation = glm::quat(orientation_of(o.value));
    state.linear_velocity = glm::vec3(p.rate[0], p.rate[1], p.rate[2]);
    state.angular_velocity = glm::vec3(angular_velocity_of(o));
    state.orientation_valid = state.position_valid = state.velocity_valid = true;
    state.orientation_tracked = state.position_tracked = true;
    return state;
}

bool pressed(const ControllerScript& controller, Button button, double time) {
    return interval_at(controller.buttons[static_cast<std::size_t>(button)], time) != nullptr;
}

void set_buttons(ControllerState& state, const ControllerScript& controller, double time) {
    const bool stick_moved = state.thumbstick.x != 0 || state.thumbstick.y != 0, pad_used = state.trackpad.x != 0 || state.trackpad.y != 0;
    state.thumbstick_click = pressed(controller, Button::thumbstick_click, time);
    state.thumbstick_touch = state.thumbstick_click || stick_moved || pressed(controller, Button::thumbstick_touch, time);
    state.trackpad_click = pressed(controller, Button::trackpad_click, time);
    state.trackpad_touch = state.trackpad_click || pad_used || pressed(controller, Button::trackpad_touch, time);
    state.trigger_touch = state.trigger > 0 || pressed(controller, Button::trigger_touch, time);
    state.a_click = pressed(controller, Button::a, time);
    state.b_click = pressed(controller, Button::b, time);
    state.menu_click = pressed(controller, Button::menu, time);
    state.system_click = pressed(controller, Button::system, time);
    state.select_click = pressed(controller, Button::select, time);
}

glm::vec2 vec2_of(const ChannelValue<2>& v) { return {static_cast<float>(v.value[0]), static_cast<float>(v.value[1])}; }

}  // namespace

const std::array<const char*, button_count>& button_names() {
    static const std::array<const char*, button_count> names{
        "thumbstick_click", "thumbstick_touch", "trackpad_click", "trackpad_touch", "trigger_touch", "a", "b", "menu", "system", "select"};
    return names;
}

TrackerScript ideal_tracker(const TrackerScript& tracker) {
    TrackerScript ideal;
    ideal.rate_hz = tracker.rate_hz;
    ideal.latency_ms = ideal.latency_jitter_ms = ideal.read_ahead_ms = 0;
    ideal.gaze_noise_deg = ideal.gaze_offset_deg = ideal.gaze_drift_deg = ideal.pupil_noise_mm = 0;
    ideal.dropout_probability = ideal.bursts_per_minute = ideal.missing_probability = 0;
    return ideal;
}

Script::Script() : head_position_m({0, 1.6, 0}), gaze_deg({0, 0}), vergence_dioptres({0.5}), pupil_mm(Channel<1>({4})) {
    controllers[0].position_m = Channel<3>({-0.2, 1.1, -0.4});
    controllers[1].position_m = Channel<3>({0.2, 1.1, -0.4});
}

double Script::local_time(DurationNs elapsed) const {
    if (elapsed <= 0) return 0;
    const auto period = static_cast<DurationNs>(std::llround(duration_s * 1e9));
    return seconds(loop && period > 0 ? elapsed % period : elapsed);
}

const Interval* interval_at(const std::vector<Interval>& intervals, double time) {
    const auto found = std::find_if(intervals.begin(), intervals.end(), [&](const Interval& i) { return time >= i.start && time < i.end; });
    return found == intervals.end() ? nullptr : &*found;
}

glm::dquat orientation_of(const std::array<double, 3>& deg) {
    return rotation(-deg[0], {0, 1, 0}) * rotation(deg[1], {1, 0, 0}) * rotation(-deg[2], {0, 0, 1});
}

glm::dvec3 angular_velocity_of(const ChannelValue<3>& deg) {
    const glm::dquat yaw = rotation(-deg.value[0], {0, 1, 0}), yaw_pitch = yaw * rotation(deg.value[1], {1, 0, 0});
    return radians_per_degree *
           (glm::dvec3(0, -deg.rate[0], 0) + yaw * glm::dvec3(deg.rate[1], 0, 0) + yaw_pitch * glm::dvec3(0, 0, -deg.rate[2]));
}

PoseState head_at(const Script& script, DurationNs elapsed) {
    const double time = script.local_time(elapsed);
    const Interval* lost = interval_at(script.head_lost, time);
    PoseState state = pose_state(script.head_position_m, lost ? lost->start : time, script.head_orientation_deg, time);
    if (lost) {
        state.position_tracked = false;
        state.linear_velocity = glm::vec3(0);
    }
    if (elapsed < 0) state.linear_velocity = state.angular_velocity = glm::vec3(0);
    return state;
}

ControllerState controller_at(const Script& script, int hand, DurationNs elapsed) {
    const ControllerScript& controller = script.controllers[static_cast<std::size_t>(hand)];
    const double time = script.local_time(elapsed);
    ControllerState state;
    if (!controller.enabled || interval_at(controller.off, time)) return state;
    const Interval* lost = interval_at(controller.lost, time);
    const double pose_time = lost ? lost->start : time;
    state.grip = pose_state(controller.position_m, pose_time, controller.orientation_deg, pose_time);
    if (lost) state.grip.position_tracked = state.grip.orientation_tracked = false;
    if (lost || elapsed < 0) state.grip.linear_velocity = state.grip.angular_velocity = glm::vec3(0);
    const glm::vec3 ahead = state.grip.pose.rotate({0, 0, -0.05f});
    state.aim = state.grip;
    state.aim.pose.position += ahead;
    state.aim.linear_velocity += glm::cross(state.grip.angular_velocity, ahead);
    state.trigger = static_cast<float>(controller.trigger.at(time).value[0]);
    state.squeeze = static_cast<float>(controller.squeeze.at(time).value[0]);
    state.thumbstick = vec2_of(controller.thumbstick.at(time));
    state.trackpad = vec2_of(controller.trackpad.at(time));
    set_buttons(state, controller, time);
    state.active = true;
    return state;
}

}  // namespace entoptic::drivers
