// What people were shown in published experiments, as calibrated light: for `entoptic stimulus`.
#pragma once

#include "base/image.h"
#include "base/result.h"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace entoptic::app {

// What the caller may choose; each stimulus has its own meaning and default for `luminance` and `test`.
struct StimulusOptions {
    std::optional<double> luminance;  // cd/m²
    std::optional<double> test;       // cd/m², of the second interval
    double filter = 1;                // neutral density filter: divides the light
};

// RGB in cd/m² in the direction x, y: degrees from the middle, right and up positive.
using Paint = std::function<std::array<double, 3>(double x_deg, double y_deg)>;

// A part of a stimulus, in which nothing moves.
struct Phase {
    double seconds = 0;
    Paint paint;
    double gaze_x_deg = 0, gaze_y_deg = 0;
};

struct StimulusEntry {
    const char* name;
    const char* preset;   // whose models the experiment was made for
    const char* source;   // paper, section or figure
    const char* summary;
    std::vector<Phase> (*phases)(const StimulusOptions& options);
};
const std::vector<StimulusEntry>& stimuli();
// Usage error that names them all.
Result<const StimulusEntry*> find_stimulus(const std::string& name);

// One phase as a picture of this size; `fov_deg` horizontally on the tangent plane.
ImageF painted(const Paint& paint, int width, int height, double fov_deg);

}  // namespace entoptic::app
