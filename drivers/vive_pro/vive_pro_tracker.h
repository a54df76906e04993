// From a headset's reports, each with its time of arrival, to where the head is and how the headset is worn. The same reports give the
// same poses, whether they come from a device or from a recording. No input or output, no clock, no threads of its own; thread-safe.
#pragma once

#include "drivers/fusion/device_clock.h"
#include "drivers/fusion/head_filter.h"
#include "drivers/fusion/pose_history.h"
#include "drivers/lighthouse/lighthouse_tracker.h"
#include "drivers/vive_pro/vive_pro_calibration.h"
#include "drivers/vive_pro/vive_pro_imu_stream.h"

#include <mutex>
#include <optional>

namespace entoptic::drivers::vive_pro {

struct TrackerStatistics {
    std::uint64_t samples = 0, lost_samples = 0, gaps = 0, restarts = 0, clock_jumps = 0;
    std::uint64_t malformed = 0;  // reports that were none
    std::uint64_t light_events = 0, hits = 0;
    lighthouse::TrackerReport lighthouse;
    double drift_ppm = 0;
    TimeNs newest_sample = 0;  // 0: none yet
};

struct MainboardReading {
    bool worn = false, system_button = false;
    double ipd_mm = 0;  // 0: not a distance that the slider can have
    std::uint16_t proximity = 0;
    TimeNs time = 0;  // of arrival; 0: never
};

class Tracker final : public PoseSource {
public:
    Tracker(const Calibration& calibration, const ImuRanges& ranges);

    // Reports as they were read, with the id. The functions' reports may come from three threads.
    void imu_report(Bytes report, TimeNs arrival);
    void light_report(Bytes report, TimeNs arrival);
    void mainboard_report(Bytes report, TimeNs arrival);

    PoseState pose_at(TimeNs time) override { return history_.at(time); }
    MainboardReading mainboard() const;
    TrackerStatistics statistics() const;

private:
    void decoded(std::vector<lighthouse::Hit> hits);

    const Calibration calibration_;
    const ImuRanges ranges_;
    PoseHistory history_;
    mutable std::mutex mutex_;  // what follows; never held while a pose is solved
    ImuStream stream_;
    DeviceClock clock_;
    HeadFilter filter_;
    lighthouse::SweepDecoder sweeps_;
    lighthouse::LighthouseTracker lighthouse_;
    WornState worn_;
    MainboardReading mainboard_;
    TrackerStatistics statistics_;
};

}  // namespace entoptic::drivers::vive_pro
