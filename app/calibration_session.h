// Shows targets and even light in a headset, one step after the other, and notes what its eye tracker says meanwhile. Without an OpenXR
// application: straight to the compositor.
#pragma once

#include "app/config.h"
#include "base/result.h"
#include "interfaces/observer.h"

#include <array>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace entoptic::app {

struct CalibrationStep {
    std::optional<glm::dvec2> target_deg;  // right and up from straight ahead, seen from between the eyes; none: no target
    bool white = false;                    // the whole view is the panel's white, else its black
    double seconds = 1.5;
};

struct CalibrationSample {
    std::size_t step = 0;
    double since_s = 0;  // from the step's first light to the sample's exposure; negative: before
    int eye = 0;
    RawEyeSample raw;
    glm::dvec2 target_deg{0};  // where this eye has to look for the target: it does not sit between the eyes
};

// Opens the headset that `config` says, with its eye tracker uncalibrated and without any effect. With the virtual headset the wearer follows the
// steps (looks at the target 0.2 s after it moves, the pupil follows the light), on the lockstep clock. `progress`: steps done, of how many.
// ErrorKind::missing: there is no eye tracker.
Result<std::vector<CalibrationSample>> run_calibration(const Config& config, const std::vector<CalibrationStep>& steps,
                                                       const std::function<void(std::size_t, std::size_t)>& progress);

// The script of a virtual wearer who follows the steps, as text.
std::string wearer_script(const std::vector<CalibrationStep>& steps);

}  // namespace entoptic::app
