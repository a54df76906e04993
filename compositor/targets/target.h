// Where panel codes go: nowhere (headless), a window, or a headset's panel. Used from the compositor's thread only, but for what says
// otherwise.
#pragma once

#include "compositor/frame.h"

#include <string>

namespace entoptic::compositor {

// One picture for the display.
struct PresentState {
    const FrameDescription* frame = nullptr;
    FramePath* path = nullptr;  // its panel() holds the codes; compose() is not running
};

// What became of a picture.
struct PresentFeedback {
    bool shown = true;       // false: nobody can have seen it, the display is away
    TimeNs vblank_time = 0;  // the refresh that began to show it, CLOCK_MONOTONIC; 0: the display does not tell
    DurationNs period = 0;   // from refresh to refresh, as measured; 0 with vblank_time
};

class DisplayTarget {
public:
    virtual ~DisplayTarget() = default;
    // Whether commit() could show this now. Changes nothing that is shown.
    virtual Result<void> test(const PresentState& state) = 0;
    // Hands the picture over; returns before it is shown.
    virtual Result<void> commit(const PresentState& state) = 0;
    // After a commit() without error: waits until the picture comes to light, where the display tells. Bounded.
    virtual Result<PresentFeedback> wait_shown() { return PresentFeedback{}; }
    // The user asked to re-centre the gaze since this was asked last; thread-safe.
    virtual bool take_recentre_wish() { return false; }
    virtual bool close_wanted() const { return false; }  // the user closed it; thread-safe
    virtual bool lit() const { return true; }            // somebody could see it now; thread-safe
    virtual std::string description() const = 0;         // thread-safe; of a display that is away: why
};

}  // namespace entoptic::compositor
