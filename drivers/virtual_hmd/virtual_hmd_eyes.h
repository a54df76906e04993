// The wearer's eyes, and the simulated eye tracker that looks at them: a stream of raw samples with the errors real trackers have,
// through the same filter (drivers/eye_tracking) as theirs. Sample k is a pure function of (script, seed, k).
#pragma once

#include "base/time.h"
#include "drivers/eye_tracking/eye_filter.h"
#include "drivers/virtual_hmd/virtual_hmd_script.h"
#include "interfaces/sources.h"

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

namespace entoptic::drivers {

// What the eyes really do.
struct EyeTruth {
    std::array<GazeAngles, 2> gaze_deg;  // each eye's own, head coordinates
    double pupil_mm = 4;                 // 0 when the script says that the tracker sees none
    double lid_open = 1;
};

class VirtualEyes {
public:
    // `script` must outlive this. `spontaneous_blinks` adds those of the script's rate, at times drawn from `seed`.
    VirtualEyes(const Script& script, double ipd_mm, std::uint64_t seed, bool spontaneous_blinks);
    EyeTruth at(DurationNs elapsed) const;

private:
    std::array<GazeAngles, 2> gaze_at(double time) const;
    double lid_at(DurationNs elapsed, double time) const;
    double spontaneous_lid(double elapsed_s) const;

    const Script& script_;
    double half_ipd_m_;
    std::uint64_t seed_;
    bool spontaneous_;
};

// The raw samples of one eye's camera.
class RawEyeStream {
public:
    // `eyes` and `script` must outlive this. Sample k is exposed at start_time + phase + k periods; phase is 2 ms for the right eye.
    RawEyeStream(const Script& script, const TrackerScript& tracker, const VirtualEyes& eyes, std::uint64_t seed, TimeNs start_time,
                 int eye);

    TimeNs exposure(std::int64_t k) const;
    TimeNs arrival(std::int64_t k) const;  // increases with k
    // None when the tracker is lost then or the sample never arrives. k >= 0.
    std::optional<RawEyeSample> sample(std::int64_t k) const;
    // The newest k whose exposure is not after `time`; negative before the first.
    std::int64_t index_at(TimeNs time) const;

private:
    bool lost(std::int64_t k) const;
    bool dropped(std::int64_t k) const;
    GazeAngles gaze_error(std::int64_t k) const;
    void find_nothing(RawEyeSample& sample, std::int64_t k) const;
    double draw(int what, std::int64_t k) const;  // uniform in [0, 1)
    double draw_normal(int what, std::int64_t k) const;

    const Script& script_;
    const TrackerScript tracker_;
    const VirtualEyes& eyes_;
    std::uint64_t seed_;
    TimeNs start_time_;
    DurationNs period_, phase_;
    GazeAngles offset_{0};
};

class VirtualEyeTracker final : public EyeSource {
public:
    // `script` must outlive this.
    VirtualEyeTracker(const Script& script, const TrackerScript& tracker, const VirtualEyes& eyes, std::uint64_t seed, TimeNs start_time,
                      const std::array<Fov, 2>& gaze_limits);

    // From what had arrived read_ahead_ms before `time`. Any order of questions gives the same answers, as long as they go back less
    // than the filter's history. A jump of more than a minute forward begins anew, with ten seconds of samples before `time`.
    Observer observer_at(TimeNs time) override;
    // Exact for any time; within a lost interval: the newest sample from before it. None when that is older than a minute.
    std::optional<RawEyeSample> raw_at(int eye, TimeNs time) override;
    bool present() const override { return true; }
    std::string description() const override;

    const RawEyeStream& stream(int eye) const { return streams_[static_cast<std::size_t>(eye)]; }

private:
    void feed_until(TimeNs time);
    void advance(std::size_t eye);

    const Script& script_;
    const TrackerScript tracker_;
    TimeNs start_time_;
    std::array<RawEyeStream, 2> streams_;
    EyeFilter filter_;
    mutable std::mutex mutex_;
    std::array<std::int64_t, 2> next_{};                  // index after pending_
    std::array<std::optional<RawEyeSample>, 2> pending_;  // generated, not yet arrived
    TimeNs fed_until_, newest_question_;
};

}  // namespace entoptic::drivers
