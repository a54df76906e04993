// `entoptic bench`: speed against error on this device.
#include "app/bench/effect_rows.h"
#include "app/bench/foveation_rows.h"
#include "app/bench/frame_times.h"
#include "app/bench/plot.h"
#include "app/bench/storage_rows.h"
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "app/parse.h"
#include "perception/preset.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <memory>
#include <optional>

namespace entoptic::app {
namespace {

struct Options {
    std::string size = "720x800", preset{perception::default_preset}, plot, only;
    int frames = 30;
    bool quick = false, json = false, progress = false;
};
constexpr std::string_view foveation = "foveation", storage = "storage", whole_frames = "frames";  // beside the slots, for --only
constexpr int quick_frames = 8;
constexpr double row_seconds = 1, quick_row_seconds = 0.3;  // of timed frames

// What was measured.
struct Measured {
    std::vector<EffectRow> rows;
    std::optional<FrameTimes> frame;
};

Json row_json(const EffectRow& row) {
    return {
        {"effect", row.effect},
        {"model", row.model},
        {"setting", row.setting},
        {"default", row.is_default},
        {"chosen", row.is_chosen},
        {"fastest_unseen", row.is_fastest_unseen},
        {"time_ms", {{"median", row.time_ms.median}, {"p95", row.time_ms.p95}, {"mean", row.time_ms.mean}, {"least", row.time_ms.least}}},
        {"error",
         {{"de_itp_p99", row.error.de_itp_p99},
          {"de_itp_mean", row.error.de_itp_mean},
          {"max_code", row.error.max_code},
          {"energy", row.error.energy}}}};
}

Json bench_json(const gpu::Device& device, const Options& o, const Measured& measured) {
    Json list = Json::array();
    for (const EffectRow& row : measured.rows) list.push_back(row_json(row));
    Json document{{"version", ENTOPTIC_VERSION},
                  {"device", fmt::format("{} ({})", device.name(), device.driver())},
                  {"size", o.size},
                  {"preset", o.preset},
                  {"rows", list}};
    if (!measured.frame) return document;
    const FrameTimes& frame = *measured.frame;
    Json presets = Json::object(), stages = Json::object();
    const auto stages_of = [](const FrameTime& time) {
        Json by_name = Json::object();
        for (const auto& [name, ms] : time.stages_ms) by_name[name] = ms;
        return by_name;
    };
    for (const FrameTime& time : frame.presets) {
        presets[time.preset] = time.total_ms;
        stages[time.preset] = stages_of(time);
    }
    stages["off"] = stages_of(frame.off);
    stages["off_in_stages"] = stages_of(frame.off_in_stages);
    stages["idle"] = stages_of(frame.idle);
    document["frame"] = {{"off_ms", frame.off.total_ms},   {"off_in_stages_ms", frame.off_in_stages.total_ms},
                         {"preset_ms", presets},           {"idle_ms", frame.idle.total_ms},
                         {"stages_ms", stages}};
    return document;
}

void print_rows(const std::vector<EffectRow>& rows) {
    fmt::print("{:<11} {:<20} {:<24} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10}\n", "effect", "model", "setting", "ms", "ms p95", "dE p99",
               "dE mean", "max code", "energy");
    for (const EffectRow& r : rows)
        fmt::print("{:<11} {:<20} {:<24} {:>9.3f} {:>9.3f} {:>9.2g} {:>9.2g} {:>9.2g} {:>10.2g} {}{}\n", r.effect, r.model, r.setting,
                   r.typical_ms(), r.time_ms.p95, r.error.de_itp_p99, r.error.de_itp_mean, r.error.max_code, r.error.energy,
                   r.is_chosen ? " *" : "", r.is_fastest_unseen ? " <" : "");
    fmt::print(
        "\n*  what the model does by default    <  of those it may be compared with, the fastest whose error cannot be seen\n"
        "   (p99 dE_ITP at most 1, mean at most 0.2)\n");
}

// A frame's time, and what share of perception's each slot has.
void print_frame(const std::string& what, const FrameTime& time) {
    const double perceive = time.stage_ms("perceive"), optics = time.stage_ms("warp") + time.stage_ms("lens");
    fmt::print("{:<34} {:>9.2f}", what, time.total_ms);
    if (optics > 0) fmt::print(" {:>9.2f} {:>9.2f} {:>9.2f}", time.stage_ms("warp"), time.stage_ms("lens"), perceive);
    if (optics > 0 && perceive > 0) fmt::print(" {:>9.2f}", perceive / optics);
    for (const auto& [stage, ms] : time.stages_ms)
        if (perceive > 0 && stage.starts_with("perceive.") && ms >= 0.01 * perceive)
            fmt::print("  {} {:.0f} %", stage.substr(std::string_view("perceive.").size()), 100 * ms / perceive);
    fmt::print("\n");
}

void print_frames(const FrameTimes& frames) {
    fmt::print("\n{:<34} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "whole frame, both eyes, median ms", "total", "warp", "lens", "perceive", "ratio");
    print_frame("off, one pass", frames.off);
    print_frame("off, in stages", frames.off_in_stages);
    print_frame(frames.idle.preset + ", nothing to see", frames.idle);
    for (const FrameTime& time : frames.presets) print_frame(time.preset, time);
    fmt::print("ratio: perceive over warp and lens; then the shares of perceive that are 1 % or more\n");
}

void print_table(const gpu::Device& device, const Options& o, const Measured& measured) {
    fmt::print("{} ({}), {} an eye\n\n", device.name(), device.driver(), o.size);
    if (!measured.rows.empty()) print_rows(measured.rows);
    if (measured.frame) print_frames(*measured.frame);
}

// What a plot's errors are taken against.
const char* truth_of(const std::string& effect) {
    return effect == foveation ? "errors against the full image"
           : effect == storage ? "errors against the unrounded scene"
                               : "errors against double precision at 13.85 pixels a degree";
}

// What the models do by default in one picture, each slot in one, and each model that has settings to choose from.
Result<void> write_plots(const std::string& folder, const std::vector<EffectRow>& rows, const std::string& machine) {
    std::map<std::string, std::vector<EffectRow>> plots;
    for (const EffectRow& row : rows) {
        if (row.setting == "default") {
            plots["speed_error"].push_back(row);
            plots["speed_error_" + row.effect].push_back(row);
        }
        plots["speed_error_" + row.effect + "_" + row.model].push_back(row);
    }
    for (const auto& [name, shown] : plots) {
        if (shown.size() < 2) continue;
        const EffectRow& first = shown[0];
        const bool of_model = name.ends_with("_" + first.model);
        const std::string title = name == "speed_error" ? "Models at their defaults"
                                  : of_model            ? first.effect + ": " + first.model
                                                        : first.effect;
        ENTOPTIC_CHECK(
            write_plot(fmt::format("{}/{}.svg", folder, name), shown, title, fmt::format("{}; {}", machine, truth_of(first.effect))));
    }
    return {};
}

Result<EffectBenchOptions> effect_options(const Options& o) {
    const auto size = size_from(o.size);
    if (!size || std::min(size->first, size->second) < 16 || std::max(size->first, size->second) > 4096)
        return usage_error(fmt::format("--size {}: write WIDTHxHEIGHT of one eye, each from 16 to 4096.", o.size));
    EffectBenchOptions options;
    options.preset = o.preset;
    options.all_models = !o.quick;
    options.width = size->first;
    options.height = size->second;
    options.frames = o.quick ? quick_frames : o.frames;
    options.seconds = o.quick ? quick_row_seconds : row_seconds;
    if (o.only.empty()) return options;
    const std::size_t equals = o.only.find('=');
    options.slot = o.only.substr(0, equals);
    options.model = equals == std::string::npos ? "" : o.only.substr(equals + 1);
    if ((options.slot == foveation || options.slot == storage || options.slot == whole_frames) && options.model.empty()) return options;
    const auto slots = perception::slots();
    if (std::find(slots.begin(), slots.end(), options.slot) == slots.end())
        return usage_error(fmt::format("--only {}: there is no slot '{}'. Slots: {}, {}, {}, {}.", o.only, options.slot, fmt::join(slots, ", "),
                                       foveation, storage, whole_frames));
    // Names the models there are.
    if (!options.model.empty()) ENTOPTIC_CHECK(perception::select(o.preset, {o.only}));
    return options;
}

using Rows = Result<std::vector<EffectRow>> (*)(gpu::Device&, const EffectBenchOptions&);

Result<Measured> measure(gpu::Device& device, const Options& o, EffectBenchOptions options) {
    Measured measured;
    const auto add = [&](bool wanted, const char* what, Rows rows_of) -> Result<void> {
        if (!wanted) return {};
        Progress progress(what, o.progress);
        options.progress = [&](std::size_t done, std::size_t total) { progress.update(done, total); };
        ENTOPTIC_TRY(rows, rows_of(device, options));
        measured.rows.insert(measured.rows.end(), rows.begin(), rows.end());
        return {};
    };
    const bool all = options.slot.empty();
    const bool beside = options.slot == foveation || options.slot == storage || options.slot == whole_frames;
    ENTOPTIC_CHECK(add(all || !beside, "models and settings", &effect_rows));
    ENTOPTIC_CHECK(add(all || options.slot == foveation, "foveated images", &foveation_rows));
    ENTOPTIC_CHECK(add(all || options.slot == storage, "storage formats", &storage_rows));
    if (!all && options.slot != whole_frames) return measured;
    Progress progress("whole frames", o.progress);
    options.progress = [&](std::size_t done, std::size_t total) { progress.update(done, total); };
    ENTOPTIC_TRY(frame, frame_times(device, options));
    measured.frame = frame;
    return measured;
}

Result<int> bench(const Options& o) {
    ENTOPTIC_TRY(options, effect_options(o));
    ENTOPTIC_CHECK(perception::select(o.preset));
    if (!o.plot.empty() && !std::filesystem::is_directory(o.plot))
        return failure(fmt::format("--plot {}: there is no such folder. Make it first.", o.plot));
    ENTOPTIC_TRY(device, gpu::Device::create({}));
    ENTOPTIC_TRY(measured, measure(*device, o, options));
    if (!o.plot.empty())
        ENTOPTIC_CHECK(write_plots(o.plot, measured.rows, fmt::format("{} ({}), {} an eye", device->name(), device->driver(), o.size)));
    if (o.json)
        print_json(bench_json(*device, o, measured));
    else
        print_table(*device, o, measured);
    return 0;
}

}  // namespace

void add_bench(CLI::App& app, Action& action) {
    auto o = std::make_shared<Options>();
    CLI::App* c =
        app.add_subcommand("bench",
                           "Measure speed against error on this device: each model at its default and at the settings that buy time with "
                           "error, foveated images, whole frames.\n"
                           "--quick needs about two minutes of processor time, without it some ten, most of it for the double-precision "
                           "references: on two idle cores half of\n"
                           "that. Other programs that run meanwhile make it longer, and the times worse");
    c->add_flag("--quick", o->quick, "Only the models of the preset, and fewer frames");
    c->add_option("--only", o->only, "SLOT, SLOT=MODEL, foveation, storage or frames: nothing else is measured");
    c->add_flag("--json", o->json, "One JSON document on standard output");
    c->add_option("--plot", o->plot, "Folder to draw speed_error.svg, speed_error_SLOT.svg and speed_error_SLOT_MODEL.svg into");
    c->add_option("--size", o->size, "Pixels of one eye");
    c->add_option("--preset", o->preset, "Preset whose adaptation and tone the models are shown with, and whose defaults are marked");
    c->add_option("--frames", o->frames, "Timed frames a setting, at most")->check(CLI::Range(1, 10000));
    c->add_flag("--progress", o->progress, "Tell progress even without a terminal");
    c->callback([o, &action] { action = [o] { return bench(*o); }; });
}

}  // namespace entoptic::app
