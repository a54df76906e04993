// What app/ hands to the OpenXR runtime: the one place where runtime, drivers and compositor are wired together.
#pragma once

#include "base/result.h"
#include "base/time.h"
#include "interfaces/frame_service.h"
#include "interfaces/headset.h"
#include "interfaces/layers.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace entoptic {

struct ApplicationIdentity {
    std::string name, engine;                    // from XrApplicationInfo
    std::uint32_t application_version = 0, engine_version = 0;
    std::uint64_t api_version = 0;
    std::vector<std::string> extensions;         // enabled
};

// Mistakes of an application that the runtime makes up for, from its profile (applications/*.toml). Without them the specification holds.
struct Quirks {
    // Elements of an array that a call fills may lack their type: type and next are set instead of refused.
    bool untyped_arrays = false;
};

// The services behind one XrInstance.
class RuntimeHost {
public:
    virtual ~RuntimeHost() = default;
    virtual Headset& headset() = 0;
    // The session clock: CLOCK_MONOTONIC in real time, virtual in lockstep. XrTime is this clock's.
    virtual Clock& clock() = 0;
    virtual bool lockstep() const = 0;
    // Real time that passes, to measure how long work takes; not XrTime.
    virtual Clock& stopwatch() = 0;
    virtual FrameService& frames() = 0;
    // Luminance of layers whose application does not say: from the command line, an application profile, or the SDR default.
    virtual LayerLuminance default_luminance() const = 0;
    // A value the command line imposes even on layers that carry XR_ENTOPTICX_scene_luminance is not offered: the layer wins.
    // Size applications are told to render one eye at.
    virtual void recommended_eye_size(std::uint32_t& width, std::uint32_t& height) const = 0;
    // Half a period of the finest grating that is seen where the left and the right eye look, rad: by the eye in the scene when its acuity is
    // simulated, else by the wearer's own at the panel. Thread-safe.
    virtual std::array<double, 2> resolved_angles_rad() const = 0;
    virtual Quirks quirks() const { return {}; }
    // A problem the user should know of; goes to the report's `errors` and to the log.
    virtual void report_error(const std::string& message) = 0;
};

// Called once per xrCreateInstance. The error's message goes to the log; xrCreateInstance returns XR_ERROR_RUNTIME_UNAVAILABLE for
// ErrorKind::missing and XR_ERROR_RUNTIME_FAILURE else.
using RuntimeHostFactory = Result<std::unique_ptr<RuntimeHost>> (*)(const ApplicationIdentity&);

}  // namespace entoptic
