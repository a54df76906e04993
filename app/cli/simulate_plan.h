// What `entoptic simulate` is asked for, and as checked values.
#pragma once

#include "app/parse.h"
#include "app/simulation/scene_input.h"
#include "app/simulation/trace.h"
#include "perception/preset.h"

#include <optional>
#include <string>
#include <vector>

namespace entoptic::app {

constexpr double default_age = 30;  // years, of the default eye

struct SimulateOptions {
    std::string input, output, projection, trace, adapted_to = "scene", at, preset{perception::default_preset}, observer, report;
    std::optional<std::string> gaze, pupil;
    std::vector<std::string> models, settings;
    std::optional<double> fov_deg;
    SceneOptions scene;
    double fps = 0;
    std::uint64_t seed = 1;
    bool reference = false, photographic = false, dither = false, json = false, progress = false;
};

// The options as values, checked.
struct SimulatePlan {
    std::vector<InputFile> files;
    NumberedName output;
    std::optional<Projection> projection;
    drivers::GazeAngles gaze{0};  // where no trace says otherwise
    std::optional<double> pupil_mm, adapted_to;
    std::optional<Trace> trace;
    double age = default_age;   // of the eye whose pupil is modelled
    std::vector<double> times;  // of a still picture, s
    perception::Selection selection;
};

// Errors name the option and what it takes. What is asked for twice, or changes nothing, is said on standard error.
Result<SimulatePlan> make_plan(const SimulateOptions& options);

// Says on standard error what was chosen and cannot be seen in this picture.
void tell_idle(const perception::Selection& selection, bool has_depth);

}  // namespace entoptic::app
