// `entoptic calibrate gaze` and `entoptic calibrate pupil`: guided, with the error before and after, into the observer's file.
#include "app/calibration_session.h"
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "app/observer_calibration.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>

namespace entoptic::app {
namespace {

using drivers::EyeCalibration;
using drivers::GazePair;

constexpr float least_confidence = 0.8f;         // of a sample that counts (facts/devices.md 4.6)
constexpr double step_s = 1.5, settled_s = 0.5;  // of a target, and after it has moved: reaction, saccade, the camera's delay
constexpr double adapting_s = 4, looking_s = 7;  // of a white or black view: the pupil needs some seconds; the rest is measured
constexpr std::size_t fewest_diameters = 30;
const char* const sides[2] = {"left", "right"};

struct Options {
    std::optional<std::string> observer, hmd, eye_tracker;
    std::optional<std::uint64_t> seed;
    bool json = false;
};

// Degrees right and up. Learnt; and held out, between the learnt ones, never fitted.
const std::vector<glm::dvec2> taught_targets{{0, 0}, {-15, 0}, {15, 0}, {0, 12}, {0, -12}, {-13, 10}, {13, -10}, {13, 10}, {-13, -10}};
const std::vector<glm::dvec2> held_out_targets{{-7, 5}, {7, -5}, {7, 5}, {-7, -5}, {0, 6}};

Result<Config> config_of(const Options& o) {
    ENTOPTIC_TRY(config, load_config(std::nullopt));
    if (o.hmd) config.hmd.value = *o.hmd;
    if (o.eye_tracker) config.eye_tracker.value = *o.eye_tracker;
    if (o.seed) config.seed.value = *o.seed;
    if (o.observer) config.observer.value = *o.observer;
    if (config.observer.value.empty()) config.observer.value = "me";
    if (config.observer.value.find('/') != std::string::npos)
        return usage_error(fmt::format("'{}' cannot be an observer's name: it names a file in observers/.", config.observer.value));
    ENTOPTIC_CHECK(read_calibration(config.observer.value));  // a file that cannot be read is said before the session, not after it
    return config;
}

Result<std::vector<CalibrationSample>> measured(const Config& config, const std::vector<CalibrationStep>& steps) {
    Progress progress("steps", false);
    return run_calibration(config, steps, [&](std::size_t done, std::size_t all) { progress.update(done, all); });
}

void print_use(const std::string& path, const std::string& observer) {
    fmt::print("Written to {}. Use it with --observer {}, or observer = \"{}\" in config.toml.\n", path, observer, observer);
}

std::vector<GazePair> pairs_of(const std::vector<CalibrationSample>& samples, int eye, bool held_out) {
    std::vector<GazePair> pairs;
    for (const CalibrationSample& s : samples) {
        const glm::dvec3 direction = s.raw.gaze_direction;
        if (s.eye != eye || (s.step >= taught_targets.size()) != held_out || s.since_s < settled_s ||
            !(s.raw.confidence >= least_confidence))
            continue;
        if (!(glm::length(direction) > 0.5 && glm::length(direction) < 2) || direction.z >= 0) continue;
        pairs.push_back({drivers::angles_of(direction), s.target_deg});
    }
    return pairs;
}

Result<int> calibrate_gaze(const Options& options) {
    ENTOPTIC_TRY(config, config_of(options));
    std::vector<CalibrationStep> steps;
    for (const auto* list : {&taught_targets, &held_out_targets})
        for (const glm::dvec2& target : *list) steps.push_back({target, false, step_s});
    fmt::print(stderr, "Follow the bright square with your eyes, {:.0f} seconds long.\n", step_s * static_cast<double>(steps.size()));
    ENTOPTIC_TRY(samples, measured(config, steps));
    EyeCalibration calibration;
    Json json = {{"observer", config.observer.value}, {"held_out_targets", held_out_targets.size()}};
    std::string lines;
    for (int eye = 0; eye < 2; ++eye) {
        const auto e = static_cast<std::size_t>(eye);
        const auto taught = pairs_of(samples, eye, false), held_out = pairs_of(samples, eye, true);
        const auto map = drivers::fit_gaze_map(taught);
        if (!map) return failure(fmt::format("The {} eye could not be calibrated, nothing was changed. {}", sides[e], map.error().message));
        calibration.gaze[e] = *map;
        const double before = drivers::median_error_deg({}, held_out), after = drivers::median_error_deg(*map, held_out);
        json[sides[e]] = {{"samples", taught.size()}, {"held_out_samples", held_out.size()}, {"before_deg", before}, {"after_deg", after}};
        lines += fmt::format("{} eye: {:.2f} degrees before, {:.2f} after (median at {} targets that were kept out)\n", sides[e], before,
                             after, held_out_targets.size());
    }
    ENTOPTIC_TRY(path, write_calibration(config.observer.value, calibration));
    json["file"] = path;
    if (options.json) {
        print_json(json);
    } else {
        fmt::print("{}", lines);
        print_use(path, config.observer.value);
    }
    return 0;
}

// The median of what was measured in a step after the pupil has come to rest.
Result<double> diameter_in(const std::vector<CalibrationSample>& samples, std::size_t step) {
    std::vector<double> diameters;
    for (const CalibrationSample& s : samples)
        if (s.step == step && s.since_s >= adapting_s && s.raw.confidence >= least_confidence && s.raw.pupil_diameter_mm > 1)
            diameters.push_back(s.raw.pupil_diameter_mm);
    if (diameters.size() < fewest_diameters)
        return failure(
            fmt::format("Only {} pictures showed a pupil. Keep the eyes open, look around first so that the eye's model settles, "
                        "and try again.",
                        diameters.size()));
    const auto middle = diameters.begin() + static_cast<long>(diameters.size() / 2);
    std::nth_element(diameters.begin(), middle, diameters.end());
    return *middle;
}

Result<int> calibrate_pupil(const Options& options) {
    ENTOPTIC_TRY(config, config_of(options));
    fmt::print(stderr, "Keep looking ahead: a white view, then a black one, {:.0f} seconds each.\n", looking_s);
    ENTOPTIC_TRY(samples, measured(config, {{glm::dvec2(0), true, looking_s}, {glm::dvec2(0), false, looking_s}}));
    ENTOPTIC_TRY(narrowest, diameter_in(samples, 0));
    ENTOPTIC_TRY(widest, diameter_in(samples, 1));
    if (widest < narrowest + 0.3)
        return failure(
            fmt::format("The pupil was {:.1f} mm in white and {:.1f} mm in black: it did not follow the light. Nothing was changed. "
                        "Check that no light from outside reaches the eyes.",
                        narrowest, widest));
    EyeCalibration calibration;
    calibration.pupil_range_mm = {narrowest, widest};
    ENTOPTIC_TRY(path, write_calibration(config.observer.value, calibration));
    if (options.json) {
        print_json({{"observer", config.observer.value}, {"narrowest_mm", narrowest}, {"widest_mm", widest}, {"file", path}});
    } else {
        fmt::print("Pupil: {:.2f} mm in white, {:.2f} mm in black.\n", narrowest, widest);
        print_use(path, config.observer.value);
    }
    return 0;
}

void add_one(CLI::App& parent, const char* name, const char* what, Result<int> (*run)(const Options&), Action& action) {
    auto options = std::make_shared<Options>();
    CLI::App* command = parent.add_subcommand(name, what);
    command->add_option("--observer", options->observer,
                        "Whose file in observers/ it goes into (default: the configuration's, else \"me\")");
    command->add_option("--hmd", options->hmd, "The headset: virtual or vive-pro (default: the configuration's)");
    command->add_option("--eye-tracker", options->eye_tracker, "auto, headset or pupil-labs (default: the configuration's)");
    command->add_option("--seed", options->seed, "Virtual headset: seed of its tracker's errors");
    command->add_flag("--json", options->json, "One JSON document on standard output");
    command->callback([options, run, &action] { action = [options, run] { return run(*options); }; });
}

}  // namespace

void add_eye_calibration(CLI::App& calibrate, Action& action) {
    add_one(calibrate, "gaze", "A moving target: where the eyes really look, error in degrees before and after", calibrate_gaze, action);
    add_one(calibrate, "pupil", "A white and a black view: the range of the pupil in mm", calibrate_pupil, action);
}

}  // namespace entoptic::app
