// When frames are begun, composed and shown. Pure bookkeeping over times that callers pass in: no thread, no clock, no lock.
//
// The display refreshes at start + k·period (k = 0, 1, 2 …): composition for refresh k must end by then; the middle of its light comes
// `vblank_to_photon` later.
#pragma once

#include "base/time.h"
#include "interfaces/frame_service.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace entoptic::compositor {

struct RefreshGrid {
    TimeNs start = 0;
    DurationNs period = ns_per_s / 90;
    DurationNs vblank_to_photon = 0;

    TimeNs deadline(std::int64_t k) const { return start + k * period; }
    TimeNs light(std::int64_t k) const { return deadline(k) + vblank_to_photon; }
    // The refresh whose deadline is nearest to `time`; may be negative.
    std::int64_t nearest(TimeNs time) const;
    // The first refresh whose deadline is not before `time`.
    std::int64_t first_at(TimeNs time) const;
};

// How long something takes, from the last eight times it did: the second longest, so that one hiccup does not count and a habit does.
class DurationEstimate {
public:
    explicit DurationEstimate(DurationNs before_any) : before_any_(before_any) {}
    void add(DurationNs duration);
    DurationNs value() const;

private:
    DurationNs before_any_;
    std::deque<DurationNs> last_;
};

// Pacing on a real clock.
//
// - An application may start its next frame as soon as it has begun the last one, but no earlier than it has to, to be in time for the
//   refresh after the one promised last, and not while an older frame of its own still waits to be composed. A slow compositor slows the
//   application down to its own pace; nobody runs ahead by more than one frame.
// - The predicted display time is that of the first refresh that the frame can make, given how long the application and the composition
//   took lately and what the compositor is busy with. Predictions rise by whole periods, and the application is told the period of the pace
//   that it is kept to, not the display's, when it does not get every refresh.
// - The compositor wakes just in time for a refresh (estimate + margin before it) and takes the newest frame that was promised for it or
//   earlier. If none is new, it composes the last one again with the newest pose: reprojection.
// - On a device that needs more than a period for a frame (lavapipe), reprojecting would take the processor away from the application, and
//   the next frame would only come later: there a picture stands until a new frame arrives, new frames are composed at once, and the
//   refreshes in between count as missed.
class FramePacing {
public:
    explicit FramePacing(const RefreshGrid& grid);

    // The application's side.
    struct Prediction {
        std::int64_t refresh = 0;
        TimeNs display_time = 0;  // middle of its light
        TimeNs start_time = 0;    // when the application should start, at the earliest
        DurationNs period = 0;    // between frames at the present pace: one to sixteen periods of the display, the median of the last promises
    };
    Prediction predict(TimeNs now);
    void application_took(DurationNs duration) { application_.add(duration); }

    // The compositor's side. The next refresh worth composing for, and when to wake for it. Never one that was taken before.
    struct Plan {
        std::int64_t refresh = 0;
        TimeNs wake_time = 0;
    };
    Plan plan(TimeNs now) const;
    // A composition in time for each refresh is possible: the last frame may be shown again with a newer pose.
    bool keeps_up() const;
    // Whether a frame promised for refresh `promised` may be shown at `refresh` already.
    bool may_show(std::int64_t promised, std::int64_t refresh) const;
    // Composition for `refresh` begins; or nothing is done for it.
    void taken(std::int64_t refresh, TimeNs now, bool composing);
    // Returns the refresh at which the picture is really shown: the planned one, or the first after `now`.
    // Where the display tells, `vblank` is when it really began to show it and `period` the time between its refreshes: the grid follows,
    // and numbers of refreshes go on. 0: it does not tell.
    std::int64_t composed(TimeNs now, TimeNs vblank = 0, DurationNs period = 0);

    const RefreshGrid& grid() const { return grid_; }

private:
    void follow(TimeNs vblank, DurationNs period);
    DurationNs lead() const;  // before a deadline that composition has to begin

    RefreshGrid grid_;
    DurationEstimate composition_, application_;
    std::deque<std::int64_t> steps_;  // from promise to promise, in refreshes
    std::int64_t last_promised_ = -1, last_taken_ = -1, last_shown_ = -1;
    TimeNs composing_since_ = 0;
    bool composing_ = false, first_composition_ = true;
};

// What became of every frame, and the counts of a session.
struct FrameCounts {
    std::uint64_t submitted = 0;  // by the application
    std::uint64_t displayed = 0;  // of these, shown at least once
    std::uint64_t reused = 0;     // refreshes at which an older frame was composed again with a newer pose
    std::uint64_t missed = 0;     // refreshes between the first light and the last at which the picture before simply stood
    std::uint64_t discarded = 0;  // begun, never submitted
    std::uint64_t unseen = 0;     // pictures composed while the display was away
};

class PresentationLog {
public:
    explicit PresentationLog(std::size_t capacity = 4096) : capacity_(capacity) {}
    void predicted(std::uint64_t frame_id, TimeNs display_time);
    void submitted(std::uint64_t frame_id, TimeNs time);
    void discarded(std::uint64_t frame_id);
    // A composition of `frame_id` came to light at refresh `refresh`, its middle at `light`. In lockstep refreshes count compositions.
    void shown(std::uint64_t frame_id, std::int64_t refresh, TimeNs light);
    // A picture was composed, and no display was there to show it: from the one before on, refreshes are not counted as missed.
    void unseen() {
        ++counts_.unseen;
        current_.reset();
    }
    // The picture is taken away (end of the session): later refreshes are not counted as missed.
    void cleared() { current_.reset(); }

    const FrameCounts& counts() const { return counts_; }
    std::vector<PresentationRecord> records(std::size_t count) const;  // oldest first

private:
    PresentationRecord* find(std::uint64_t frame_id);
    struct Current {
        std::uint64_t frame_id = 0;
        std::int64_t refresh = 0;
    };
    std::size_t capacity_;
    std::deque<PresentationRecord> records_;
    std::optional<Current> current_;
    FrameCounts counts_;
};

}  // namespace entoptic::compositor
