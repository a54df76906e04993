// A recording as a headset: the recorded samples through the same code as a live device's, at their own times.
#pragma once

#include "drivers/driver.h"
#include "drivers/eye_tracking/eye_filter.h"
#include "drivers/pupil_labs/eye_processor.h"
#include "drivers/recording/recorded_samples.h"
#include "drivers/recording/recording.h"
#include "drivers/vive_pro/vive_pro_tracker.h"

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace entoptic::drivers {

extern const Driver replay_driver;

struct RecordedPicture {
    TimeNs arrival = 0;
    EyePicture picture;
};

// A recording in memory, checked.
struct RecordedSession {
    std::string hmd;  // "virtual", "vive-pro"
    int panel_width = 1440, panel_height = 1600;
    double ipd_mm = 63;
    bool eye_tracker = false;
    std::string configuration;  // of a Vive Pro; else empty
    vive_pro::ImuRanges ranges;
    std::vector<RecordedPose> poses;        // each list in the order of its times
    std::vector<RecordedEye> eyes;          // by arrival
    std::vector<Record> reports;            // of a Vive Pro
    std::vector<RecordedPicture> pictures;  // of eye cameras, by arrival
    bool pictures_left_out = false;         // there are more than memory is given to; the samples they gave are in `eyes`
    std::vector<Record> events;
    TimeNs start = 0, end = 0;     // of the first and last sample
    std::uint64_t malformed = 0;   // records that say nothing
    std::uint64_t lost_bytes = 0;  // at the end, where the file was cut
};
constexpr std::uint64_t max_session_bytes = 1ull << 30;
// Errors: the file cannot be read; its description is wrong; more than a gigabyte without the pictures. Pictures that take more than
// `max_picture_bytes` are left out, all of them.
Result<RecordedSession> load_session(const std::string& path, std::uint64_t max_picture_bytes = max_session_bytes);

// Answers at the session's own times plus `shift`: time of the recording = asked time − shift.
class ReplayHead final : public PoseSource {
public:
    // `calibration`: of a Vive Pro, whose reports are decoded again; else the recorded poses are given out. `session` must outlive this.
    ReplayHead(const RecordedSession& session, const vive_pro::Calibration* calibration, DurationNs shift);
    PoseState pose_at(TimeNs time) override;
    // Of reports decoded again; empty without.
    vive_pro::TrackerStatistics statistics() const;

private:
    void feed_until(TimeNs time);

    const RecordedSession& session_;
    DurationNs shift_;
    std::mutex mutex_;
    std::size_t next_ = 0;
    std::unique_ptr<vive_pro::Tracker> tracker_;
    PoseHistory history_;
};

// Where there are pictures of eye cameras, they go through detector and eye model again; else the recorded samples are given out.
class ReplayEyes final : public EyeSource {
public:
    ReplayEyes(const RecordedSession& session, const std::array<Fov, 2>& limits, DurationNs shift);
    Observer observer_at(TimeNs time) override;
    std::optional<RawEyeSample> raw_at(int eye, TimeNs time) override;
    bool present() const override { return session_.eye_tracker; }
    std::string description() const override;

private:
    void feed_until(TimeNs time);

    // Through which pictures of one eye go, and for which camera it was made.
    struct Eye {
        std::optional<EyeProcessor> processor;
        std::string product;
        int width = 0, height = 0;
    };
    void look_at(const RecordedPicture& recorded);

    const RecordedSession& session_;
    DurationNs shift_;
    std::mutex mutex_;
    std::size_t next_ = 0;
    std::array<Eye, 2> looking_;
    EyeFilter filter_;
};

// The Headset of a session that begins at `start_time`.
Result<Headset> replay_headset(std::shared_ptr<const RecordedSession> session, TimeNs start_time);

}  // namespace entoptic::drivers
