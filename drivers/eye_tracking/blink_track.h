// Blinks of one eye, from the tracker's confidence, and the lid's course that the compositor shows. A plain value.
#pragma once

#include "base/time.h"
#include "drivers/eye_tracking/eye_filter_parameters.h"

namespace entoptic::drivers {

class BlinkTrack {
public:
    // Returns true when this sample makes a blink certain. `time` of exposure, increasing; `arrival` of the sample.
    bool add(const BlinkParameters& parameters, TimeNs time, TimeNs arrival, double confidence);

    // The sample just added may be used: confidence is not low, and no blink ended within the margin before it.
    bool usable(const BlinkParameters& parameters, TimeNs time) const;
    // Shut at `now` (arrival), as far as is known; a blink longer than `longest` is a lost eye.
    bool blinking(const BlinkParameters& parameters, TimeNs now) const { return confirmed_ && now - detected_ < parameters.longest; }
    TimeNs onset() const { return onset_; }  // exposure of the first sample of low confidence
    // Arrival time until which a blink explains that nothing is seen.
    TimeNs explained_until(const BlinkParameters& parameters) const;
    bool any() const { return any_; }
    // 1 open, 0 closed, at `now` (arrival); continuous.
    double lid_open(const BlinkParameters& parameters, TimeNs now) const;

private:
    TimeNs opening_start(const BlinkParameters& parameters) const;

    bool low_ = false, confirmed_ = false;  // in a run of low confidence; long enough for a blink
    bool any_ = false;                      // there has been a blink: the times below mean something
    TimeNs onset_ = 0;                      // exposure
    TimeNs detected_ = 0, ended_ = 0;       // arrival
    TimeNs ended_exposure_ = 0;
    double lid_at_detection_ = 1;
};

}  // namespace entoptic::drivers
