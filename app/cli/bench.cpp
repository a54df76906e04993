// `entoptic bench`: speed against error on this device.
#include "app/bench/effect_rows.h"
#include "app/bench/frame_times.h"
#include "app/bench/plot.h"
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "app/parse.h"
#include "perception/preset.h"

#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <memory>

namespace entoptic::app {
namespace {

struct Options {
    std::string size = "720x800", preset{perception::default_preset}, plot;
    int frames = 30;
    bool quick = false, json = false, progress = false;
};
constexpr int quick_frames = 8;

Json row_json(const EffectRow& row) {
    return {{"effect", row.effect},
            {"model", row.model},
            {"setting", row.setting},
            {"default", row.is_default},
            {"time_ms", {{"median", row.time_ms.median}, {"p95", row.time_ms.p95}}},
            {"error",
             {{"de_itp_p99", row.error.de_itp_p99},
              {"de_itp_mean", row.error.de_itp_mean},
              {"max_code", row.error.max_code},
              {"energy", row.error.energy}}}};
}

Json bench_json(const gpu::Device& device, const Options& o, const std::vector<EffectRow>& rows, const FrameTimes& frame) {
    Json list = Json::array(), presets = Json::object();
    for (const EffectRow& row : rows) list.push_back(row_json(row));
    for (const auto& [name, ms] : frame.preset_ms) presets[name] = ms;
    return {{"version", ENTOPTIC_VERSION},
            {"device", fmt::format("{} ({})", device.name(), device.driver())},
            {"size", o.size},
            {"rows", list},
            {"frame", {{"off_ms", frame.off_ms}, {"preset_ms", presets}, {"idle_ms", frame.idle_ms}}}};
}

void print_table(const gpu::Device& device, const Options& o, const std::vector<EffectRow>& rows, const FrameTimes& frame) {
    fmt::print("{} ({}), {} an eye\n\n", device.name(), device.driver(), o.size);
    fmt::print("{:<11} {:<20} {:<20} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10}\n", "effect", "model", "setting", "ms", "ms p95", "dE p99", "dE mean", "max code",
               "energy");
    for (const EffectRow& r : rows)
        fmt::print("{:<11} {:<20} {:<20} {:>9.3f} {:>9.3f} {:>9.2g} {:>9.2g} {:>9.2g} {:>10.2g}\n", r.effect, r.model, r.setting, r.time_ms.median,
                   r.time_ms.p95, r.error.de_itp_p99, r.error.de_itp_mean, r.error.max_code, r.error.energy);
    fmt::print("\nWhole frame, both eyes: off {:.2f} ms, nothing to see {:.2f} ms", frame.off_ms, frame.idle_ms);
    for (const auto& [name, ms] : frame.preset_ms) fmt::print(", {} {:.2f} ms", name, ms);
    fmt::print("\n");
}

// All rows in one picture, and those of each slot in one of its own.
Result<void> write_plots(const std::string& folder, const std::vector<EffectRow>& rows, const std::string& title) {
    ENTOPTIC_CHECK(write_plot(folder + "/speed_error.svg", rows, title));
    std::map<std::string, std::vector<EffectRow>> by_slot;
    for (const EffectRow& row : rows) by_slot[row.effect].push_back(row);
    for (const auto& [slot, of_slot] : by_slot)
        ENTOPTIC_CHECK(write_plot(fmt::format("{}/speed_error_{}.svg", folder, slot), of_slot, fmt::format("{}: {}", slot, title)));
    return {};
}

Result<int> bench(const Options& o) {
    const auto size = size_from(o.size);
    if (!size || std::min(size->first, size->second) < 16 || std::max(size->first, size->second) > 4096)
        return usage_error(fmt::format("--size {}: write WIDTHxHEIGHT of one eye, each from 16 to 4096.", o.size));
    if (!o.plot.empty() && !std::filesystem::is_directory(o.plot))
        return failure(fmt::format("--plot {}: there is no such folder. Make it first.", o.plot));
    ENTOPTIC_TRY(device, gpu::Device::create({}));
    Progress progress("measurements", o.progress);
    EffectBenchOptions options;
    options.preset = o.preset;
    options.all_models = !o.quick;
    options.width = size->first;
    options.height = size->second;
    options.frames = o.quick ? quick_frames : o.frames;
    options.progress = [&](std::size_t done, std::size_t total) { progress.update(done, total); };
    ENTOPTIC_TRY(rows, effect_rows(*device, options));
    ENTOPTIC_TRY(frame, frame_times(*device, size->first, size->second, options.frames));
    if (!o.plot.empty())
        ENTOPTIC_CHECK(write_plots(o.plot, rows, fmt::format("{} on {}, {}", o.preset, device->name(), o.size)));
    if (o.json)
        print_json(bench_json(*device, o, rows, frame));
    else
        print_table(*device, o, rows, frame);
    return 0;
}

}  // namespace

void add_bench(CLI::App& app, Action& action) {
    auto o = std::make_shared<Options>();
    CLI::App* c = app.add_subcommand("bench", "Measure speed against error on this device");
    c->add_flag("--quick", o->quick, "Only the models of the preset, and fewer frames");
    c->add_flag("--json", o->json, "One JSON document on standard output");
    c->add_option("--plot", o->plot, "Folder to draw speed_error.svg and speed_error_SLOT.svg into");
    c->add_option("--size", o->size, "Pixels of one eye");
    c->add_option("--preset", o->preset, "Preset in which the models are measured, one at a time in its slot");
    c->add_option("--frames", o->frames, "Timed frames a setting")->check(CLI::Range(1, 10000));
    c->add_flag("--progress", o->progress, "Tell progress even without a terminal");
    c->callback([o, &action] { action = [o] { return bench(*o); }; });
}

}  // namespace entoptic::app
