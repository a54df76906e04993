// Where panel codes go: nowhere (headless), or a window. Used from the compositor's thread only, but for close_wanted().
#pragma once

#include "compositor/frame.h"

#include <string>

namespace entoptic::compositor {

// One picture for the display.
struct PresentState {
    const FrameDescription* frame = nullptr;
    FramePath* path = nullptr;  // its panel() holds the codes; compose() is not running
};

struct PresentFeedback {
    TimeNs light_time = 0;  // middle of the light, where the display tells; 0: it does not
};

class DisplayTarget {
public:
    virtual ~DisplayTarget() = default;
    // Whether commit() could show this now. Changes nothing.
    virtual Result<void> test(const PresentState& state) = 0;
    virtual Result<PresentFeedback> commit(const PresentState& state) = 0;
    virtual bool close_wanted() const { return false; }  // the user closed it; thread-safe
    virtual std::string description() const = 0;
};

}  // namespace entoptic::compositor
