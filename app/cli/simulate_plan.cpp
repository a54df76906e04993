#include "app/cli/simulate_plan.h"

#include "app/cli/command.h"
#include "app/observer_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <set>

namespace entoptic::app {
namespace {

using namespace perception;

constexpr double longest_time_s = 3600;

bool writes(const NumberedName& name, const std::string& text, const char* extension) {
    return std::filesystem::path(text).extension() == extension || std::filesystem::path(name.with(0, 0)).extension() == extension;
}

// Nothing that is read is written over.
Result<void> expect_inputs_kept(const SimulateOptions& o, const SimulatePlan& plan) {
    namespace fs = std::filesystem;
    std::error_code error;
    std::set<fs::path> read;
    for (const InputFile& file : plan.files) read.insert(fs::weakly_canonical(file.path, error));
    if (!o.trace.empty()) read.insert(fs::weakly_canonical(o.trace, error));
    std::vector<std::string> written;
    for (const InputFile& file : plan.files)
        for (const double time_s : plan.times) written.push_back(plan.output.with(file.number, time_s));
    if (!o.report.empty()) written.push_back(o.report);
    for (const std::string& path : written)
        if (read.count(fs::weakly_canonical(path, error)) > 0)
            return usage_error(fmt::format("'{}' is an input: the output would take its place. Name another file.", path));
    return {};
}

Result<void> plan_output(const SimulateOptions& o, SimulatePlan& plan) {
    ENTOPTIC_TRY(output, NumberedName::parse(o.output));
    plan.output = output;
    if (!writes(output, o.output, ".exr") && !writes(output, o.output, ".png"))
        return usage_error(
            fmt::format("'{}': the output's name must end in .exr (display light, cd/m²) or .png (as the display shows it).", o.output));
    const auto folder = std::filesystem::path(o.output).parent_path();
    if (!folder.empty() && !std::filesystem::is_directory(folder))
        return failure(fmt::format("There is no folder '{}' to write to. Make it first.", folder.string()));
    const bool sequence = plan.files.size() > 1 || o.fps > 0;
    if (sequence && !output.has_number())
        return usage_error("A numbered sequence needs a frame number in the output's name, such as out_%04d.png.");
    if (!sequence && output.has_number()) return usage_error("One picture has no frame number: take the %d out of the output's name.");
    if (plan.times.size() > 1 && !output.has_time()) return usage_error("Several times need %t in the output's name, such as out_%t.png.");
    if (o.dither && !writes(output, o.output, ".png")) return usage_error("--dither is for the codes of a .png; an .exr has no codes.");
    return expect_inputs_kept(o, plan);
}

Result<void> plan_times(const SimulateOptions& o, SimulatePlan& plan) {
    const bool sequence = plan.files.size() > 1;
    if (sequence && !(o.fps > 0)) return usage_error("A numbered sequence needs --fps, its frames a second.");
    if (sequence && !o.at.empty()) return usage_error("--at goes with one picture; a sequence has times of its own.");
    plan.times = {0};
    if (o.at.empty()) return {};
    const auto times = numbers_from(o.at);
    if (!times) return usage_error(fmt::format("--at {}: write seconds with commas between them, such as 0,0.5,10.", o.at));
    plan.times = *times;
    std::sort(plan.times.begin(), plan.times.end());
    if (plan.times.front() < 0 || plan.times.back() > longest_time_s)
        return usage_error(fmt::format("--at {}: times lie between 0 and {:g} seconds after the scene appears.", o.at, longest_time_s));
    return {};
}

Result<void> plan_eye(const SimulateOptions& o, SimulatePlan& plan) {
    if (o.gaze) {
        const auto gaze = numbers_from(*o.gaze);
        if (!gaze || gaze->size() != 2 || std::abs((*gaze)[0]) > 180 || std::abs((*gaze)[1]) > 90)
            return usage_error(fmt::format(
                "--gaze {}: write X,Y in degrees from the centre, right and up positive: X from -180 to 180, Y from -90 to 90.", *o.gaze));
        plan.gaze = {(*gaze)[0], (*gaze)[1]};
    }
    if (o.pupil && *o.pupil != "model") {
        plan.pupil_mm = number_from(*o.pupil);
        if (!plan.pupil_mm || *plan.pupil_mm < 1.5 || *plan.pupil_mm > 9)
            return usage_error(fmt::format("--pupil {}: write a diameter from 1.5 to 9 mm, or 'model'.", *o.pupil));
    }
    if (o.adapted_to != "scene") {
        plan.adapted_to = number_from(o.adapted_to);
        if (!plan.adapted_to || *plan.adapted_to < 1e-6 || *plan.adapted_to > 1e8)
            return usage_error(fmt::format("--adapted-to {}: write a luminance from 1e-6 to 1e8 cd/m², or 'scene'.", o.adapted_to));
    }
    if (o.trace.empty()) return {};
    ENTOPTIC_TRY(trace, Trace::read(o.trace));
    if (o.gaze && trace.has_gaze()) return usage_error(fmt::format("--gaze does not go with '{}', which has a gaze of its own.", o.trace));
    if (o.pupil && trace.has_pupil())
        return usage_error(fmt::format("--pupil does not go with '{}', which has pupils of its own.", o.trace));
    plan.trace = std::move(trace);
    return {};
}

bool says_model_of(const SimulateOptions& o, const std::string& slot) {
    return std::any_of(o.models.begin(), o.models.end(), [&](const std::string& model) { return model.starts_with(slot + "="); });
}

// The eye that blinks in the trace is nobody's own here, so that its lid has to darken the picture, unless --model says otherwise.
std::vector<std::string> models_with_lid(const SimulateOptions& o, const std::optional<Trace>& trace) {
    std::vector<std::string> models = o.models;
    if (trace && trace->has_blinks() && !says_model_of(o, "eyelid") && o.preset != "off") models.emplace_back("eyelid=blink");
    return models;
}

// Pupils that are given or modelled here are those of the eye in the scene, so that a preset's model, which makes them of what a tracker
// measured in front of a display, has nothing to do; only one that --model names has.
Result<void> plan_pupil(const SimulateOptions& o, SimulatePlan& plan) {
    const Choice* choice = plan.selection.find("pupil");
    if (!choice) return {};
    if (says_model_of(o, "pupil")) {
        if (plan.pupil_mm || (plan.trace && plan.trace->has_pupil())) return {};
        return usage_error(
            fmt::format("--model pupil={} needs pupils as an eye tracker measured them: give --pupil MM, or --trace with pupil_mm.",
                        choice->entry->name));
    }
    for (std::size_t i = 0; i < choice->parameters.size(); ++i)
        if (std::string_view(choice->entry->parameters[i].name) == "age") plan.age = static_cast<double>(choice->parameters[i]);
    std::erase_if(plan.selection.choices, [](const Choice& c) { return c.entry->slot == "pupil"; });
    return {};
}

Result<Selection> plan_selection(const SimulateOptions& o, const std::optional<Trace>& trace) {
    const Viewer viewer = o.photographic ? Viewer::reader : Viewer::onlooker;
    ENTOPTIC_TRY(selection, select_effects(o.preset, models_with_lid(o, trace), o.settings, o.observer, viewer));
    if (!o.photographic) return selection;
    bool known = false;
    for (Choice& choice : selection.choices)
        for (std::size_t i = 0; i < choice.entry->parameters.size(); ++i)
            if (std::string_view(choice.entry->parameters[i].name) == "photographic") {
                choice.parameters[i] = 1;
                known = true;
            }
    if (selection.choices.empty())
        fmt::print(stderr, "entoptic: --photographic changes nothing here: no model is chosen.\n");
    else if (!known)
        fmt::print(stderr,
                   "entoptic: --photographic changes nothing here: these models scatter the whole scene already, not only what the display "
                   "cannot show.\n");
    return selection;
}

}  // namespace

Result<SimulatePlan> make_plan(const SimulateOptions& o) {
    SimulatePlan plan;
    if (o.projection == "equirect") plan.projection = Projection::equirect;
    if (o.projection == "rectilinear") plan.projection = Projection::rectilinear;
    ENTOPTIC_CHECK(plan_eye(o, plan));
    ENTOPTIC_TRY(selection, plan_selection(o, plan.trace));
    plan.selection = std::move(selection);
    ENTOPTIC_CHECK(plan_pupil(o, plan));
    ENTOPTIC_TRY(files, input_files(o.input));
    plan.files = std::move(files);
    ENTOPTIC_CHECK(plan_times(o, plan));
    ENTOPTIC_CHECK(plan_output(o, plan));
    tell_twice(o.models, "--model");
    tell_twice(o.settings, "--set");
    return plan;
}

// What was asked for and cannot be seen in this picture.
void tell_idle(const Selection& selection, bool has_depth) {
    const auto is_on = [](const Choice& choice, std::string_view name) {
        for (std::size_t i = 0; i < choice.parameters.size(); ++i)
            if (name == choice.entry->parameters[i].name) return choice.parameters[i] > 0.5f;
        return false;
    };
    if (selection.find("dof") && !has_depth)
        fmt::print(stderr, "entoptic: the picture has no channel Z (metres): without depth all of it stays in focus.\n");
    for (const Choice& choice : selection.choices)
        if (is_on(choice, "emission_spectra") && is_on(choice, "photographic"))
            fmt::print(stderr, "entoptic: {0}.emission_spectra changes nothing with {0}.photographic.\n", choice.entry->slot);
}

}  // namespace entoptic::app
