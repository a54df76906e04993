#include "drivers/eye_tracking/eye_filter.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace entoptic::drivers {

namespace {

// Differences of times inside this range cannot overflow.
constexpr TimeNs latest_time = 4'000'000'000'000'000'000;
TimeNs bounded(TimeNs time) { return std::clamp(time, -latest_time, latest_time); }

constexpr double largest_gaze_angle_deg = 75;   // an eye does not turn farther: garbage
constexpr DurationNs oldest_sample = ns_per_s;  // a sample older than this when it arrives says nothing of now

std::optional<GazeAngles> valid_gaze(const RawEyeSample& sample) {
    const glm::dvec3 direction = sample.gaze_direction;
    const double length = glm::length(direction);
    if (!(length > 0.5 && length < 2)) return std::nullopt;  // NaN and infinities fail too
    const GazeAngles angles = angles_of(direction);
    if (direction.z >= 0 || std::abs(angles.x) > largest_gaze_angle_deg || std::abs(angles.y) > largest_gaze_angle_deg) return std::nullopt;
    return angles;
}

std::optional<double> valid_pupil(const PupilFilterParameters& parameters, const RawEyeSample& sample) {
    const double diameter = sample.pupil_diameter_mm;
    if (!(diameter >= parameters.min_mm && diameter <= parameters.max_mm)) return std::nullopt;
    return diameter;
}

// Not a number, or outside 0..1: no confidence.
double valid_confidence(const RawEyeSample& sample) {
    return sample.confidence >= 0 && sample.confidence <= 1 ? double(sample.confidence) : 0.0;
}

GazeAngles inside(const Fov& fov, GazeAngles angles) {
    return {std::clamp(angles.x, double(fov.angle_left) * degrees_per_radian, double(fov.angle_right) * degrees_per_radian),
            std::clamp(angles.y, double(fov.angle_down) * degrees_per_radian, double(fov.angle_up) * degrees_per_radian)};
}

}  // namespace

EyeFilter::EyeFilter(const EyeFilterParameters& parameters) : parameters_(parameters), latest_(parameters) {}

void EyeFilter::reset() {
    const std::lock_guard lock(mutex_);
    latest_ = State(parameters_);
    history_.clear();
    raw_.clear();
    forgotten_ = false;
}

bool EyeFilter::acceptable(int eye, const RawEyeSample& sample) const {
    if (eye < 0 || eye > 1 || sample.arrival != bounded(sample.arrival) || sample.time != bounded(sample.time)) return false;
    if (sample.time > sample.arrival || sample.arrival - sample.time > oldest_sample) return false;
    const Eye& last = latest_.eyes[static_cast<std::size_t>(eye)];
    return (history_.empty() || sample.arrival >= latest_.arrival) && (!last.sampled || sample.time > last.newest_time);
}

void EyeFilter::add(int eye, const RawEyeSample& sample) {
    const std::lock_guard lock(mutex_);
    if (!acceptable(eye, sample)) return;
    update(latest_, eye, sample);
    history_.push_back(latest_);
    raw_.push_back({eye, sample});
    while (history_.size() > 1 && sample.arrival - history_[1].arrival > parameters_.history) {
        history_.pop_front();
        raw_.pop_front();
        forgotten_ = true;
    }
}

void EyeFilter::update(State& state, int eye, const RawEyeSample& sample) const {
    Eye& e = state.eyes[static_cast<std::size_t>(eye)];
    const double dt = e.sampled ? seconds(sample.time - e.newest_time) : 0;
    const double confidence = valid_confidence(sample);
    state.arrival = sample.arrival;
    state.pupil.advance(parameters_.pupil, sample.arrival);
    const bool other_sees = gaze_fresh(state.eyes[static_cast<std::size_t>(1 - eye)], sample.arrival);
    e.sampled = true;
    e.newest_time = sample.time;
    e.newest_arrival = sample.arrival;
    e.confidence = confidence;
    if (e.blink.add(parameters_.blink, sample.time, sample.arrival, confidence)) {
        const TimeNs before = e.blink.onset() - parameters_.blink.margin;
        e.gaze.roll_back(before);
        if (!other_sees) state.pupil.roll_back(before);
    }
    if (confidence < parameters_.min_confidence || !e.blink.usable(parameters_.blink, sample.time)) return;
    if (const auto diameter = valid_pupil(parameters_.pupil, sample)) {
        state.pupil.add(parameters_.pupil, eye, *diameter);
        e.pupil_seen = true;
        e.pupil_arrival = sample.arrival;
    }
    if (const auto angles = valid_gaze(sample)) {
        e.gaze.add(parameters_.gaze, sample.time, sample.arrival, inside(parameters_.gaze_limits[static_cast<std::size_t>(eye)], *angles));
        update_vergence(state, eye, sample, dt);
    }
}

void EyeFilter::update_vergence(State& state, int eye, const RawEyeSample& sample, double dt) const {
    const GazeTrack &left = state.eyes[0].gaze, &right = state.eyes[1].gaze;
    const Eye& other = state.eyes[static_cast<std::size_t>(1 - eye)];
    const bool together = other.gaze.seen() && sample.time - other.gaze.sample_time() <= parameters_.gaze.vergence_window;
    if (!together || left.in_saccade() || right.in_saccade()) return;
    const GazeAngles now = left.estimate() - right.estimate();
    const double gain = state.vergence_known ? -std::expm1(-dt / parameters_.gaze.vergence_tau_s) : 1.0;
    state.vergence += gain * (now - state.vergence);
    state.vergence_known = true;
}

// The state after the last sample that had arrived; a copy in which time goes on.
EyeFilter::State EyeFilter::state_at(TimeNs known_until) const {
    const auto after = std::upper_bound(history_.begin(), history_.end(), known_until,
                                        [](TimeNs time, const State& state) { return time < state.arrival; });
    if (after == history_.begin() && !forgotten_) return State(parameters_);
    State state = after == history_.begin() ? *after : *(after - 1);
    state.pupil.advance(parameters_.pupil, known_until);
    return state;
}

bool EyeFilter::gaze_fresh(const Eye& eye, TimeNs now) const {
    return eye.gaze.seen() && now - eye.gaze.sample_arrival() <= parameters_.gaze.hold && !eye.blink.blinking(parameters_.blink, now);
}

// How much of the last gaze is left: 1 while it is held, then easing to 0.
double EyeFilter::gaze_share(const Eye& eye, TimeNs now) const {
    if (!eye.gaze.seen()) return 0;
    TimeNs ease_start = eye.gaze.sample_arrival() + parameters_.gaze.hold;
    if (eye.blink.any()) {
        const TimeNs explained = eye.blink.explained_until(parameters_.blink);
        if (explained > eye.gaze.sample_arrival()) ease_start = std::max(ease_start, explained + parameters_.gaze.hold);
    }
    return now <= ease_start ? 1 : std::exp(-seconds(now - ease_start) / parameters_.gaze.ease_tau_s);
}

// The eye that was seen last eases to the centre, the other one to where that eye looks, apart by their last vergence.
std::array<GazeAngles, 2> EyeFilter::gaze_of(const State& state, TimeNs now, TimeNs time) const {
    const GazeTrack &left = state.eyes[0].gaze, &right = state.eyes[1].gaze;
    const std::size_t best = right.seen() && (!left.seen() || right.sample_arrival() > left.sample_arrival()) ? 1 : 0;
    const std::size_t other = 1 - best;
    std::array<GazeAngles, 2> gaze;
    gaze[best] = gaze_share(state.eyes[best], now) * state.eyes[best].gaze.predicted(parameters_.gaze, time);
    const GazeAngles target = gaze[best] + (best == 0 ? -state.vergence : state.vergence);
    const double share = gaze_share(state.eyes[other], now);
    gaze[other] = share * state.eyes[other].gaze.predicted(parameters_.gaze, time) + (1 - share) * target;
    for (std::size_t eye = 0; eye < 2; ++eye) gaze[eye] = inside(parameters_.gaze_limits[eye], gaze[eye]);
    return gaze;
}

EyeState EyeFilter::eye_state(const State& state, int eye, GazeAngles gaze, TimeNs now) const {
    const Eye& e = state.eyes[static_cast<std::size_t>(eye)];
    const bool silent = !e.sampled || now - e.newest_arrival > parameters_.silent;
    EyeState result;
    result.gaze_direction = glm::normalize(glm::vec3(direction_of(gaze)));
    result.pupil_diameter_mm =
        static_cast<float>(std::clamp(state.pupil.diameter_mm(), parameters_.pupil.min_mm, parameters_.pupil.max_mm));
    result.eyelid_open = static_cast<float>(e.blink.lid_open(parameters_.blink, now));
    const bool gaze_measured = gaze_fresh(e, now);
    const bool pupil_measured = e.pupil_seen && now - e.pupil_arrival <= parameters_.pupil.hold;
    const Provenance fallback = silent ? Provenance::absent : Provenance::modelled;
    result.gaze_provenance = gaze_measured ? Provenance::measured : fallback;
    result.pupil_provenance = pupil_measured ? Provenance::measured : fallback;
    result.confidence = silent ? 0.0f : static_cast<float>(e.confidence);
    result.sample_time = e.gaze.seen() ? e.gaze.sample_time() : 0;
    return result;
}

Observer EyeFilter::observer_at(TimeNs known_until, TimeNs time) const {
    const TimeNs now = bounded(known_until), then = bounded(time);
    const std::lock_guard lock(mutex_);
    const State state = state_at(now);
    const auto gaze = gaze_of(state, now, then);
    Observer observer;
    observer.time = time;
    for (int eye = 0; eye < 2; ++eye)
        observer.eyes[static_cast<std::size_t>(eye)] = eye_state(state, eye, gaze[static_cast<std::size_t>(eye)], now);
    observer.gaze_direction = glm::normalize(observer.eyes[0].gaze_direction + observer.eyes[1].gaze_direction);
    return observer;
}

std::optional<RawEyeSample> EyeFilter::raw_at(int eye, TimeNs time) const {
    const std::lock_guard lock(mutex_);
    for (auto entry = raw_.rbegin(); entry != raw_.rend(); ++entry) {
        if (entry->eye == eye && entry->sample.arrival <= time) return entry->sample;
    }
    return std::nullopt;
}

std::string EyeFilter::eye_status(const State& state, int eye, TimeNs now) const {
    const Eye& e = state.eyes[static_cast<std::size_t>(eye)];
    if (!e.sampled) return "no sample yet";
    if (now - e.newest_arrival > parameters_.silent) return fmt::format("no samples for {:.1f} s", seconds(now - e.newest_arrival));
    if (e.blink.blinking(parameters_.blink, now)) return "blink";
    if (gaze_fresh(e, now)) return "tracked";
    return e.gaze.seen() ? fmt::format("no pupil found for {:.1f} s", seconds(now - e.gaze.sample_arrival())) : "no pupil found yet";
}

std::string EyeFilter::status(TimeNs known_until) const {
    const TimeNs now = bounded(known_until);
    const std::lock_guard lock(mutex_);
    const State state = state_at(now);
    return fmt::format("left: {}, right: {}", eye_status(state, 0, now), eye_status(state, 1, now));
}

}  // namespace entoptic::drivers
