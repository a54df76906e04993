#include "drivers/virtual_hmd/virtual_hmd_eyes.h"

#include "base/noise.h"
#include "drivers/virtual_hmd/virtual_hmd_time.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace entoptic::drivers {

namespace {

constexpr double two_pi = 6.283185307179586;
constexpr double first_spontaneous_s = 1;  // no spontaneous blink earlier
constexpr DurationNs longest_catch_up = 60 * ns_per_s, warm_up = 10 * ns_per_s, longest_look_back = 60 * ns_per_s;

// What a random number is for: each has its own stream.
enum Draw {
    draw_missing,
    draw_dropout,
    draw_burst,
    draw_burst_start,
    draw_burst_length,
    draw_latency,
    draw_confidence,
    draw_noise_right,
    draw_noise_up,
    draw_pupil,
    draw_garbage,
    draw_garbage_direction,
    draw_offset_right,
    draw_offset_up,
    draw_drift_phase,
    draw_blink
};

std::uint64_t stream_seed(std::uint64_t seed, int eye, int what) {
    return mix64(seed + mix64(static_cast<std::uint64_t>(eye) * 256 + static_cast<std::uint64_t>(what)));
}

double lid_of(const Blink& blink, double time) {
    const double shut = blink.start + Blink::closing, opening = shut + blink.closed;
    if (time <= blink.start || time >= blink.end()) return 1;
    if (time < shut) return (shut - time) / Blink::closing;
    return time < opening ? 0 : (time - opening) / Blink::opening;
}

// Share of the pupil the camera sees between the lids.
double visible_share(double lid_open) { return std::clamp((lid_open - 0.3) / 0.4, 0.0, 1.0); }

DurationNs duration_of_ms(double ms) { return static_cast<DurationNs>(std::llround(ms * 1e6)); }

}  // namespace

VirtualEyes::VirtualEyes(const Script& script, double ipd_mm, std::uint64_t seed, bool spontaneous_blinks)
    : script_(script),
      half_ipd_m_(ipd_mm * 0.5e-3),
      seed_(seed),
      spontaneous_(spontaneous_blinks && script.spontaneous_blinks_per_minute > 0) {}

// Both eyes turn to the fixated point; at 0 dioptres they are parallel.
std::array<GazeAngles, 2> VirtualEyes::gaze_at(double time) const {
    std::array<GazeAngles, 2> gaze;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        if (script_.eye_gaze_deg) {
            const auto value = (*script_.eye_gaze_deg)[eye].at(time).value;
            gaze[eye] = {value[0], value[1]};
        } else {
            const auto value = script_.gaze_deg.at(time).value;
            const double eye_x = eye == 0 ? -half_ipd_m_ : half_ipd_m_;
            const double dioptres = script_.vergence_dioptres.at(time).value[0];
            gaze[eye] = angles_of(direction_of({value[0], value[1]}) - glm::dvec3(eye_x * dioptres, 0, 0));
        }
    }
    return gaze;
}

// One blink in each span of 60/rate seconds, somewhere in it.
double VirtualEyes::spontaneous_lid(double elapsed_s) const {
    const double span = 60 / script_.spontaneous_blinks_per_minute;
    if (elapsed_s < first_spontaneous_s) return 1;
    const double index = std::floor((elapsed_s - first_spontaneous_s) / span);
    const double room = span - (Blink{}.end() - Blink{}.start);
    const double start = uniform01(stream_seed(seed_, 0, draw_blink), static_cast<std::uint64_t>(index)) * room;
    return lid_of({first_spontaneous_s + index * span + start}, elapsed_s);
}

double VirtualEyes::lid_at(DurationNs elapsed, double time) const {
    double lid = spontaneous_ ? spontaneous_lid(seconds(elapsed)) : 1;
    for (const Blink& blink : script_.blinks) lid = std::min(lid, lid_of(blink, time));
    return lid;
}

EyeTruth VirtualEyes::at(DurationNs elapsed) const {
    const double time = script_.local_time(elapsed);
    return {gaze_at(time), script_.pupil_mm ? script_.pupil_mm->at(time).value[0] : 0, lid_at(elapsed, time)};
}

RawEyeStream::RawEyeStream(const Script& script, const TrackerScript& tracker, const VirtualEyes& eyes, std::uint64_t seed,
                           TimeNs start_time, int eye)
    : script_(script),
      tracker_(tracker),
      eyes_(eyes),
      seed_(mix64(seed + static_cast<std::uint64_t>(eye + 1) * 0x9e3779b97f4a7c15ull)),
      start_time_(start_time),
      period_(static_cast<DurationNs>(std::llround(1e9 / tracker.rate_hz))),
      phase_(eye * duration_of_ms(2)) {
    offset_ = tracker.gaze_offset_deg * GazeAngles{draw_normal(draw_offset_right, 0), draw_normal(draw_offset_up, 0)};
}

double RawEyeStream::draw(int what, std::int64_t k) const { return uniform01(stream_seed(seed_, 0, what), static_cast<std::uint64_t>(k)); }
double RawEyeStream::draw_normal(int what, std::int64_t k) const {
    return normal(stream_seed(seed_, 0, what), static_cast<std::uint64_t>(k));
}

TimeNs RawEyeStream::exposure(std::int64_t k) const { return start_time_ + phase_ + k * period_; }

TimeNs RawEyeStream::arrival(std::int64_t k) const {
    const double jitter = tracker_.latency_jitter_ms > 0 ? tracker_.latency_jitter_ms * (2 * draw(draw_latency, k) - 1) : 0;
    return exposure(k) + duration_of_ms(tracker_.latency_ms + jitter);
}

std::int64_t RawEyeStream::index_at(TimeNs time) const {
    const DurationNs since = elapsed_since(start_time_, time) - phase_;
    return since >= 0 ? since / period_ : -1;
}

bool RawEyeStream::lost(std::int64_t k) const {
    return interval_at(script_.eyes_lost, script_.local_time(phase_ + k * period_)) != nullptr;
}

// A single sample, or one inside a burst (at most one burst begins in each second).
bool RawEyeStream::dropped(std::int64_t k) const {
    if (draw(draw_dropout, k) < tracker_.dropout_probability) return true;
    if (tracker_.bursts_per_minute <= 0) return false;
    const double time = seconds(phase_ + k * period_), second = std::floor(time);
    const auto index = static_cast<std::int64_t>(second);
    if (draw(draw_burst, index) >= tracker_.bursts_per_minute / 60) return false;
    const double start = second + 0.88 * draw(draw_burst_start, index), length = 0.02 + 0.1 * draw(draw_burst_length, index);
    return time >= start && time < start + length;
}

// White noise, the constant error of the calibration, and a drift of three incommensurate sines.
GazeAngles RawEyeStream::gaze_error(std::int64_t k) const {
    constexpr std::array<double, 3> periods_s{17, 31, 61};
    const double time = seconds(phase_ + k * period_);
    GazeAngles drift{0};
    for (int i = 0; i < 6; ++i) {
        const double phase = draw(draw_drift_phase, i);
        drift[i % 2] += std::sin(two_pi * (time / periods_s[static_cast<std::size_t>(i / 2)] + phase));
    }
    const double amplitude = tracker_.gaze_drift_deg * std::sqrt(2.0 / 3.0);
    return offset_ + amplitude * drift +
           tracker_.gaze_noise_deg * GazeAngles{draw_normal(draw_noise_right, k), draw_normal(draw_noise_up, k)};
}

// What trackers say when they see no pupil: zeros, NaN, or a confident-looking direction out of nowhere.
void RawEyeStream::find_nothing(RawEyeSample& sample, std::int64_t k) const {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const double kind = draw(draw_garbage, k);
    sample.confidence = static_cast<float>(0.2 * draw(draw_confidence, k));
    sample.pupil_diameter_mm = kind < 0.75 ? 0 : nan;
    if (kind < 0.4)
        sample.gaze_direction = glm::vec3(nan);
    else if (kind < 0.6)
        sample.gaze_direction = glm::vec3(0);
    else
        sample.gaze_direction =
            glm::vec3(direction_of({120 * draw(draw_garbage_direction, 2 * k) - 60, 120 * draw(draw_garbage_direction, 2 * k + 1) - 60}));
}

std::optional<RawEyeSample> RawEyeStream::sample(std::int64_t k) const {
    if (lost(k) || draw(draw_missing, k) < tracker_.missing_probability) return std::nullopt;
    const int eye = phase_ == 0 ? 0 : 1;
    const EyeTruth truth = eyes_.at(phase_ + k * period_);
    const double visible = visible_share(truth.lid_open);
    RawEyeSample sample;
    sample.time = exposure(k);
    sample.arrival = arrival(k);
    if (visible < 0.25 || dropped(k)) {
        find_nothing(sample, k);
        return sample;
    }
    // A half-hidden pupil looks smaller and lower.
    const GazeAngles gaze = truth.gaze_deg[static_cast<std::size_t>(eye)] + gaze_error(k) - GazeAngles{0, 4 * (1 - visible)};
    sample.gaze_direction = glm::vec3(direction_of(gaze));
    const double noise = tracker_.pupil_noise_mm * draw_normal(draw_pupil, k);
    sample.pupil_diameter_mm = truth.pupil_mm > 0 ? static_cast<float>(truth.pupil_mm * (0.7 + 0.3 * visible) + noise) : 0;
    const double blur = tracker_.gaze_noise_deg > 0 ? 0.02 * std::abs(draw_normal(draw_confidence, k)) : 0;
    sample.confidence = static_cast<float>(std::clamp(visible * (0.98 - blur), 0.0, 1.0));
    return sample;
}

VirtualEyeTracker::VirtualEyeTracker(const Script& script, const TrackerScript& tracker, const VirtualEyes& eyes, std::uint64_t seed,
                                     TimeNs start_time, const std::array<Fov, 2>& gaze_limits)
    : script_(script),
      tracker_(tracker),
      start_time_(start_time),
      streams_{RawEyeStream(script, tracker, eyes, seed, start_time, 0), RawEyeStream(script, tracker, eyes, seed, start_time, 1)},
      filter_([&] {
          EyeFilterParameters parameters;
          parameters.gaze_limits = gaze_limits;
          return parameters;
      }()),
      fed_until_(start_time - 1),
      newest_question_(start_time) {}

void VirtualEyeTracker::advance(std::size_t eye) { pending_[eye] = streams_[eye].sample(next_[eye]++); }

// Gives the filter every sample that arrives until `time`, in order of arrival.
void VirtualEyeTracker::feed_until(TimeNs time) {
    if (time <= fed_until_) return;
    if (time - fed_until_ > longest_catch_up) {
        filter_.reset();
        pending_ = {};
        for (std::size_t eye = 0; eye < 2; ++eye) next_[eye] = std::max(next_[eye], streams_[eye].index_at(time - warm_up));
    }
    fed_until_ = time;
    for (;;) {
        for (std::size_t eye = 0; eye < 2; ++eye) {
            while (!pending_[eye] && streams_[eye].exposure(next_[eye]) <= time) advance(eye);
        }
        const bool left_first = pending_[0] && (!pending_[1] || pending_[0]->arrival <= pending_[1]->arrival);
        const std::size_t first = left_first ? 0 : 1;
        if (!pending_[first] || pending_[first]->arrival > time) return;
        filter_.add(static_cast<int>(first), *pending_[first]);
        pending_[first].reset();
    }
}

Observer VirtualEyeTracker::observer_at(TimeNs time) {
    const TimeNs asked = start_time_ + elapsed_since(start_time_, time);
    const TimeNs known_until = asked - duration_of_ms(tracker_.read_ahead_ms);
    const std::lock_guard lock(mutex_);
    feed_until(known_until);
    newest_question_ = std::max(newest_question_, known_until);
    Observer observer = filter_.observer_at(known_until, asked);
    observer.time = time;
    return observer;
}

std::optional<RawEyeSample> VirtualEyeTracker::raw_at(int eye, TimeNs time) {
    if (eye < 0 || eye > 1) return std::nullopt;
    const RawEyeStream& stream = streams_[static_cast<std::size_t>(eye)];
    const DurationNs elapsed = elapsed_since(start_time_, time);
    std::int64_t k = stream.index_at(start_time_ + elapsed);
    for (; k >= 0 && start_time_ + elapsed - stream.exposure(k) <= longest_look_back; --k) {
        if (stream.arrival(k) > start_time_ + elapsed) continue;
        if (const auto sample = stream.sample(k)) return sample;
        const double local = script_.local_time(stream.exposure(k) - start_time_);
        if (const Interval* lost = interval_at(script_.eyes_lost, local)) {
            const auto back = static_cast<DurationNs>(std::floor((local - lost->start) * 1e9));
            k = std::min(k, stream.index_at(stream.exposure(k) - back) + 1);
        }
    }
    return std::nullopt;
}

std::string VirtualEyeTracker::description() const {
    const std::lock_guard lock(mutex_);
    return fmt::format("virtual eye tracker, {:g} Hz, script {}; {}", tracker_.rate_hz, script_.name, filter_.status(newest_question_));
}

}  // namespace entoptic::drivers
