// The contract of a device, and the way in for app/: open a headset by name. One folder a device, one line in drivers.list.
//
// To add device `x`: make drivers/x/, declare `extern const Driver x_driver;` (namespace entoptic::drivers) in x/x_device.h, define it
// in x/x_device.cpp, and add `x` to drivers.list. A device is a Headset: display identity, optics and small sources; the sources answer
// from any thread, never block, and go on with documented fallbacks when the hardware leaves.
#pragma once

#include "base/result.h"
#include "base/time.h"
#include "interfaces/headset.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace entoptic::drivers {

// What a user may ask of a device. A device ignores what it has no use for.
struct DriverOptions {
    std::string name = "virtual";  // a driver's name, or "auto": the first of drivers.list that is there
    int panel_width = 1440;        // pixels of one eye, 16..8192; another size keeps the optics (same field of view, same distortion)
    int panel_height = 1600;
    double ipd_mm = 63;            // distance between the eyes, 50..80 mm
    std::string script = "still";  // virtual headset: a built-in script's name, or the path of a script file
    std::uint64_t seed = 1;        // virtual headset: same seed, same noise
    bool ideal_tracker = false;    // virtual headset: eye tracker without noise, delay, dropouts and spontaneous blinks
    bool real_time = true;         // the session's clock is CLOCK_MONOTONIC; real devices refuse another
    TimeNs start_time = 0;         // virtual headset: time 0 of the script, in the session's clock
};

struct Driver {
    const char* name;         // what the user types: "virtual"
    const char* description;  // one line
    // ErrorKind::missing: the device is not there (a probe goes on); usage: the options are wrong. Null: the device is no headset.
    Result<Headset> (*open)(const DriverOptions& options);
    // The device as an eye tracker of its own, to be worn with any headset; missing: it is not there, and why. Null: it is none.
    // `clock` must be CLOCK_MONOTONIC's and outlive the tracker.
    Result<std::shared_ptr<EyeSource>> (*open_eyes)(Clock& clock) = nullptr;
};

// Every driver of drivers.list, in its order. Never null inside.
const std::vector<const Driver*>& driver_table();

// Opens `options.name`. Errors: usage when there is no such driver (the message lists those there are) and whatever the driver says.
Result<Headset> open_headset(const DriverOptions& options);

// Opens the eye tracker `name`, or with "auto" the first that is there. Errors as above.
Result<std::shared_ptr<EyeSource>> open_eye_tracker(const std::string& name, Clock& clock);

}  // namespace entoptic::drivers
