#include "drivers/replay/replay_device.h"

#include "drivers/optics/lens_fov.h"
#include "drivers/virtual_hmd/virtual_hmd_device.h"
#include "drivers/vive_pro/vive_pro_device.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace entoptic::drivers {

namespace {

using Json = nlohmann::json;

constexpr TimeNs farthest_time = 1ll << 61;  // so that differences and shifts of times never overflow

Result<double> number(const Json& json, const char* key, double low, double high) {
    const auto found = json.find(key);
    if (found == json.end() || !found->is_number() || !(found->get<double>() >= low && found->get<double>() <= high))
        return failure(fmt::format("The recording's description: '{}' should be a number from {:g} to {:g}.", key, low, high));
    return found->get<double>();
}

Result<void> read_description(const std::string& text, RecordedSession& out) {
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) return failure("The recording's description is not a JSON object.");
    ENTOPTIC_CHECK(number(json, "version", 1, 1));
    const auto text_of = [&](const char* key) {
        const auto found = json.find(key);
        return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
    };
    out.hmd = text_of("hmd");
    out.configuration = text_of("configuration");
    ENTOPTIC_TRY(width, number(json, "panel_width", 16, 8192));
    ENTOPTIC_TRY(height, number(json, "panel_height", 16, 8192));
    ENTOPTIC_TRY(ipd, number(json, "ipd_mm", 50, 80));
    out.panel_width = static_cast<int>(width);
    out.panel_height = static_cast<int>(height);
    out.ipd_mm = ipd;
    out.eye_tracker = json.value("eye_tracker", Json()).is_boolean() && json["eye_tracker"].get<bool>();
    if (!out.configuration.empty()) {
        const Json ranges = json.value("ranges", Json());
        if (!ranges.is_object()) return failure("The recording's description has no 'ranges'.");
        ENTOPTIC_TRY(acceleration, number(ranges, "acceleration_m_s2", 1, 1000));
        ENTOPTIC_TRY(rate, number(ranges, "angular_rate_rad_s", 0.1, 200));
        out.ranges = {acceleration, rate};
    }
    return {};
}

bool possible(TimeNs time) { return time > -farthest_time && time < farthest_time; }

void take(Record record, RecordedSession& out) {
    if (!possible(record.time)) {
        ++out.malformed;
        return;
    }
    if (record.stream == Stream::pose) {
        const auto pose = decode_pose(record.payload);
        const bool in_order = pose && possible(pose->time) && (out.poses.empty() || pose->time > out.poses.back().time);
        if (in_order) out.poses.push_back(*pose);
        if (!in_order) ++out.malformed;
    } else if (record.stream == Stream::eye) {
        const auto eye = decode_eye(record.payload);
        const bool sound = eye && possible(eye->sample.time) && possible(eye->sample.arrival);
        if (sound) out.eyes.push_back(*eye);
        if (!sound) ++out.malformed;
    } else if (record.stream == Stream::vive_report) {
        out.reports.push_back(std::move(record));
    } else if (record.stream == Stream::eye_picture) {
        auto picture = decode_eye_picture(record.payload);
        const bool sound = picture && possible(picture->time);
        if (sound) out.pictures.push_back({record.time, std::move(*picture)});
        if (!sound) ++out.malformed;
    } else if (record.stream == Stream::event) {
        out.events.push_back(std::move(record));
    }  // streams of later versions are none of ours
}

Result<Headset> open(const DriverOptions& options) {
    if (options.script.empty() || options.script == DriverOptions{}.script)
        return usage_error("A replay needs its recording: --script FILE.");
    ENTOPTIC_TRY(session, load_session(options.script));
    session.panel_width = options.panel_width;  // a virtual panel has the size that this run asks for
    session.panel_height = options.panel_height;
    return replay_headset(std::make_shared<const RecordedSession>(std::move(session)), options.start_time);
}

}  // namespace

const Driver replay_driver{"replay", "a recording (entoptic record), through the code of the device it was made with", open};

Result<RecordedSession> load_session(const std::string& path, std::uint64_t max_picture_bytes) {
    ENTOPTIC_TRY(reader, RecordingReader::open(path));
    RecordedSession out;
    ENTOPTIC_CHECK(read_description(reader.description(), out));
    std::uint64_t bytes = 0, picture_bytes = 0;
    bool first = true;
    while (auto record = reader.next()) {
        const bool is_picture = record->stream == Stream::eye_picture;
        (is_picture ? picture_bytes : bytes) += record->payload.size() + 64;
        if (bytes > max_session_bytes) return failure(fmt::format("{} holds more than a gigabyte of samples; replay takes no more.", path));
        if (possible(record->time)) {
            out.start = first ? record->time : std::min(out.start, record->time);
            out.end = first ? record->time : std::max(out.end, record->time);
            first = false;
        }
        out.pictures_left_out = picture_bytes > max_picture_bytes;
        if (out.pictures_left_out) out.pictures = {};
        if (!is_picture || !out.pictures_left_out) take(std::move(*record), out);
    }
    // The two eyes' samples are written one after the other, whichever arrived first.
    std::stable_sort(out.eyes.begin(), out.eyes.end(),
                     [](const RecordedEye& a, const RecordedEye& b) { return a.sample.arrival < b.sample.arrival; });
    std::stable_sort(out.reports.begin(), out.reports.end(), [](const Record& a, const Record& b) { return a.time < b.time; });
    std::stable_sort(out.pictures.begin(), out.pictures.end(),
                     [](const RecordedPicture& a, const RecordedPicture& b) { return a.arrival < b.arrival; });
    out.lost_bytes = reader.lost_bytes();
    return out;
}

// ---- Head ---------------------------------------------------------------------------------------------------------------------------------

ReplayHead::ReplayHead(const RecordedSession& session, const vive_pro::Calibration* calibration, DurationNs shift)
    : session_(session), shift_(shift) {
    if (calibration) tracker_ = std::make_unique<vive_pro::Tracker>(*calibration, session.ranges);
}

void ReplayHead::feed_until(TimeNs time) {
    if (!tracker_) {
        for (; next_ < session_.poses.size() && session_.poses[next_].time <= time; ++next_)
            history_.push(session_.poses[next_].time, session_.poses[next_].state);
        return;
    }
    for (; next_ < session_.reports.size() && session_.reports[next_].time <= time; ++next_) {
        const Record& record = session_.reports[next_];
        if (record.payload.empty()) continue;
        const vive_pro::Bytes report(record.payload.data() + 1, record.payload.size() - 1);
        switch (static_cast<vive_pro::Source>(record.payload[0])) {
            case vive_pro::Source::imu:
                tracker_->imu_report(report, record.time);
                break;
            case vive_pro::Source::light:
                tracker_->light_report(report, record.time);
                break;
            case vive_pro::Source::mainboard:
                tracker_->mainboard_report(report, record.time);
                break;
        }
    }
}

PoseState ReplayHead::pose_at(TimeNs time) {
    const std::lock_guard lock(mutex_);
    // A recorded pose of the future is known to nobody: what the device had not sent by then is predicted, as it was.
    feed_until(time - shift_);
    return tracker_ ? tracker_->pose_at(time - shift_) : history_.at(time - shift_);
}

vive_pro::TrackerStatistics ReplayHead::statistics() const { return tracker_ ? tracker_->statistics() : vive_pro::TrackerStatistics{}; }

// ---- Eyes ---------------------------------------------------------------------------------------------------------------------------------

namespace {

EyeFilterParameters parameters_for(const std::array<Fov, 2>& limits) {
    EyeFilterParameters parameters;
    parameters.gaze_limits = limits;
    return parameters;
}

}  // namespace

ReplayEyes::ReplayEyes(const RecordedSession& session, const std::array<Fov, 2>& limits, DurationNs shift)
    : session_(session), shift_(shift), filter_(parameters_for(limits)) {}

void ReplayEyes::look_at(const RecordedPicture& recorded) {
    const EyePicture& p = recorded.picture;
    Eye& eye = looking_[static_cast<std::size_t>(p.eye)];
    // Another camera, or the same at another size: what its pictures are of is learnt anew, as live.
    if (!eye.processor || eye.product != p.product || eye.width != p.width || eye.height != p.height) {
        eye.processor.emplace(p.eye, pupil_labs_camera(p.product, p.width, p.height));
        eye.product = p.product;
        eye.width = p.width;
        eye.height = p.height;
    }
    auto sample = eye.processor->process({p.jpeg, p.time, p.sequence}, recorded.arrival);
    if (!sample) return;
    sample->arrival = recorded.arrival;
    sample->time = std::min(sample->time, sample->arrival);
    filter_.add(p.eye, *sample);
}

void ReplayEyes::feed_until(TimeNs time) {
    if (!session_.pictures.empty()) {
        for (; next_ < session_.pictures.size() && session_.pictures[next_].arrival <= time; ++next_) look_at(session_.pictures[next_]);
        return;
    }
    for (; next_ < session_.eyes.size() && session_.eyes[next_].sample.arrival <= time; ++next_)
        filter_.add(session_.eyes[next_].eye, session_.eyes[next_].sample);
}

Observer ReplayEyes::observer_at(TimeNs time) {
    const std::lock_guard lock(mutex_);
    feed_until(time - shift_);
    Observer observer = filter_.observer_at(time - shift_, time - shift_);
    observer.time = time;
    for (EyeState& eye : observer.eyes)
        if (eye.sample_time != 0) eye.sample_time += shift_;
    return observer;
}

std::optional<RawEyeSample> ReplayEyes::raw_at(int eye, TimeNs time) {
    const std::lock_guard lock(mutex_);
    feed_until(time - shift_);
    auto sample = filter_.raw_at(eye, time - shift_);
    if (sample) sample->time += shift_, sample->arrival += shift_;
    return sample;
}

std::string ReplayEyes::description() const {
    if (!session_.pictures.empty()) return fmt::format("a recording with {} pictures of eye cameras", session_.pictures.size());
    if (!session_.eye_tracker) return "the recorded headset had no eye tracker";
    return fmt::format("a recording with {} eye samples{}", session_.eyes.size(),
                       session_.pictures_left_out ? "; its pictures take more than a gigabyte and are left out" : "");
}

// ---- Headset ------------------------------------------------------------------------------------------------------------------------------

namespace {

struct Replay {
    Replay(std::shared_ptr<const RecordedSession> recorded, const vive_pro::Calibration* calibration, const std::array<Fov, 2>& limits,
           DurationNs shift)
        : session(std::move(recorded)), head(*session, calibration, shift), eyes(*session, limits, shift) {}
    std::shared_ptr<const RecordedSession> session;
    ReplayHead head;
    ReplayEyes eyes;
};

}  // namespace

Result<Headset> replay_headset(std::shared_ptr<const RecordedSession> session, TimeNs start_time) {
    std::optional<vive_pro::Calibration> calibration;
    if (!session->configuration.empty()) {
        ENTOPTIC_TRY(parsed, vive_pro::parse_calibration(session->configuration));
        if (!parsed.is_headset) return failure("The recording's configuration is not a headset's.");
        calibration = parsed;
    }
    Headset headset;
    headset.display = calibration ? vive_pro::display_of(*calibration) : virtual_display(session->panel_width, session->panel_height);
    headset.display.name += ", recorded";
    std::array<Fov, 2> limits;
    for (std::size_t side = 0; side < 2; ++side) {
        EyeOptics& optics = headset.eyes[side];
        optics.lens = calibration ? calibration->lenses[side] : virtual_lens(static_cast<int>(side));
        optics.fov = limits[side] = lens_fov(optics.lens);
        optics.head_from_eye.position.x = static_cast<float>((side == 0 ? -0.5e-3 : 0.5e-3) * session->ipd_mm);
    }
    const DurationNs shift = start_time - session->start;
    auto replay = std::make_shared<Replay>(std::move(session), calibration ? &*calibration : nullptr, limits, shift);
    headset.head = &replay->head;
    headset.eye_tracker = &replay->eyes;
    headset.owner = replay;
    return headset;
}

}  // namespace entoptic::drivers
