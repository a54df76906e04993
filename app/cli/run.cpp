// `entoptic run`: any OpenXR application under this runtime, nothing installed.
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "app/config.h"
#include "app/launch.h"
#include "app/status_file.h"
#include "app/observer_file.h"
#include "app/parse.h"
#include "drivers/recording/recording.h"
#include "drivers/virtual_hmd/virtual_hmd_script.h"
#include "drivers/vive_pro/vive_pro_connection.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <memory>
#include <unistd.h>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;

constexpr int exit_runtime_failed = 125;
constexpr int exit_command_not_found = 127;

struct Options {
    std::vector<std::string> application;
    std::optional<std::string> hmd, panel, display, clock, script, dump, preset, observer, report, target;
    std::optional<double> eye_scale, luminance;
    std::optional<std::uint64_t> frames, dump_every, seed;
    std::vector<std::string> dump_stages, models, settings;
    bool ideal_tracker = false, json = false, progress = false;
};

// ---- From the command line to the overlay's keys ---------------------------------------------------------------------------------

using Values = std::vector<std::pair<std::string, std::string>>;

void add_text(Values& values, const char* key, const std::optional<std::string>& text) {
    if (text) values.emplace_back(key, toml_string(*text));
}
template <class T> void add_number(Values& values, const char* key, const std::optional<T>& number) {
    if (number) values.emplace_back(key, fmt::format("{}", *number));
}

// The application may change its folder before the runtime reads this.
std::optional<std::string> absolute(const std::optional<std::string>& path) {
    return path ? std::optional<std::string>(fs::absolute(*path).string()) : std::nullopt;
}
std::optional<std::string> script_path(const std::optional<std::string>& script) {
    std::error_code error;
    return script && fs::exists(*script, error) ? absolute(script) : script;
}

// "glare=none" or "glare.k=8", each under its slot. Their form has been checked.
std::string model_table(const std::vector<std::string>& models) {
    std::vector<std::pair<std::string, std::string>> last;  // later ones win, TOML takes each key once
    for (const std::string& text : models) {
        const std::string slot = text.substr(0, text.find('='));
        std::erase_if(last, [&](const auto& entry) { return entry.first == slot; });
        last.emplace_back(slot, toml_string(text.substr(slot.size() + 1)));
    }
    std::vector<std::string> parts;
    for (const auto& [slot, model] : last) parts.push_back(fmt::format("{} = {}", toml_string(slot), model));
    return fmt::format("{{ {} }}", fmt::join(parts, ", "));
}
void add_settings(Values& values, const std::vector<std::string>& settings) {
    Values last;
    for (const std::string& text : settings) {
        const std::string name = text.substr(0, text.find('='));
        const auto dot = name.find('.');
        const std::string key = fmt::format("settings.{}.{}", toml_string(name.substr(0, dot)), toml_string(name.substr(dot + 1)));
        std::erase_if(last, [&](const auto& entry) { return entry.first == key; });
        const std::string value = text.substr(name.size() + 1);
        const auto number = number_from(value);
        last.emplace_back(key, number ? fmt::format("{:.17e}", *number) : toml_string(value));
    }
    values.insert(values.end(), last.begin(), last.end());
}

Values overlay_values(const Options& o, const std::optional<std::string>& report) {
    Values values;
    add_text(values, "preset", o.preset);
    add_text(values, "hmd", o.hmd);
    add_text(values, "panel", o.panel);
    add_number(values, "eye_scale", o.eye_scale);
    if (o.display) add_text(values, "display", o.display->ends_with(".toml") ? absolute(o.display) : o.display);
    add_text(values, "clock", o.clock);
    add_text(values, "script", script_path(o.script));
    add_number(values, "seed", o.seed);
    add_text(values, "target", o.target);
    add_number(values, "frames", o.frames);
    add_text(values, "observer", o.observer);
    add_number(values, "luminance", o.luminance);
    add_text(values, "report", absolute(report));
    if (o.ideal_tracker) values.emplace_back("ideal_tracker", "true");
    if (!o.models.empty()) values.emplace_back("models", model_table(o.models));
    add_settings(values, o.settings);
    add_text(values, "dump.dir", absolute(o.dump));
    if (!o.dump_stages.empty()) {
        std::vector<std::string> quoted;
        for (const std::string& stage : o.dump_stages) quoted.push_back(toml_string(stage));
        values.emplace_back("dump.stages", fmt::format("[{}]", fmt::join(quoted, ", ")));
    }
    add_number(values, "dump.every", o.dump_every);
    return values;
}

// ---- Everything that can be wrong before the application starts ---------------------------------------------------------------------

Result<void> check_writable_folder(const std::string& folder, const char* option) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (fs::is_directory(folder) && access(folder.c_str(), W_OK) == 0) return {};
    return failure(fmt::format("{} {}: this folder cannot be made or written. Choose another.", option, folder));
}

Result<void> check_outputs(const Options& o) {
    if (o.dump) ENTOPTIC_CHECK(check_writable_folder(*o.dump, "--dump"));
    if (!o.dump && (!o.dump_stages.empty() || o.dump_every)) return usage_error("--dump-stages and --dump-every need --dump DIR.");
    for (const std::string& stage : o.dump_stages)
        if (std::find(dump_stage_names.begin(), dump_stage_names.end(), stage) == dump_stage_names.end())
            return usage_error(
                fmt::format("--dump-stages: there is no stage '{}'. There are: {}.", stage, fmt::join(dump_stage_names, ", ")));
    if (!o.report) return {};
    const fs::path folder = fs::absolute(*o.report).parent_path();
    if (!fs::is_directory(folder))
        return failure(fmt::format("--report {}: there is no folder '{}'. Make it first.", *o.report, folder.string()));
    if (fs::is_directory(*o.report)) return failure(fmt::format("--report {}: this is a folder. Name a file.", *o.report));
    return {};
}

// With the configuration underneath: it must be good, too, as its errors would come out in the middle of the application's.
Result<void> check_against_config(const Options& o) {
    ENTOPTIC_TRY(base, load_config(std::nullopt));
    const std::string hmd = o.hmd.value_or(base.hmd.value), script = o.script.value_or(base.script.value);
    if (hmd == "replay") {
        if (script == Config{}.script.value) return usage_error("A replay needs its recording: --script FILE (entoptic record makes one).");
        ENTOPTIC_CHECK(drivers::RecordingReader::open(script));
    } else if (o.script) {
        ENTOPTIC_CHECK(drivers::load_script(script));
    }
    if (hmd == "vive-pro") {
        if (o.clock.value_or(base.clock.value) == "lockstep")
            return usage_error("A real headset runs in real time. Use --clock real, or --hmd virtual.");
        if (drivers::vive_pro::find_headsets(drivers::system_hid_bus()).empty())
            return missing(
                "No Vive Pro was found on USB. Plug in its link box and power, and switch it on; lsusb must list "
                "28de:2300.");
    }
    std::vector<std::string> models, settings;
    if (!o.preset) {
        models = base.model_names();
        settings = base.setting_texts();
    }
    models.insert(models.end(), o.models.begin(), o.models.end());
    settings.insert(settings.end(), o.settings.begin(), o.settings.end());
    const auto chosen = select_effects(o.preset.value_or(base.preset.value), models, settings, o.observer.value_or(base.observer.value),
                                       perception::Viewer::wearer);
    if (!chosen) return forward_error(o.preset ? chosen.error() : with_origin(chosen.error(), base));
    return {};
}

Result<void> check(const Options& o) {
    if (o.application.empty()) return usage_error("Name the application after two dashes: entoptic run -- hello_xr -g Vulkan");
    ENTOPTIC_CHECK(check_against_config(o));
    if (o.panel) {
        const auto size = size_from(*o.panel);
        if (!size || std::min(size->first, size->second) < 16 || std::max(size->first, size->second) > 8192)
            return usage_error(
                fmt::format("--panel {}: write WIDTHxHEIGHT of one eye, each from 16 to 8192, such as 1440x1600.", *o.panel));
    }
    return check_outputs(o);
}

// ---- Running ----------------------------------------------------------------------------------------------------------------------

std::string text_of_file(const fs::path& path) {
    std::ifstream in(path);
    return {std::istreambuf_iterator<char>(in), {}};
}

class Run {
public:
    Run(const Options& options, PrivateFolder folder) : o_(options), folder_(std::move(folder)), progress_("frames", options.progress) {}

    Result<int> start() {
        ENTOPTIC_TRY(manifest, find_manifest());
        std::error_code ignored;
        if (const auto path = report_path()) fs::remove(*path, ignored);  // an earlier run's must not pass for this one's
        const std::string config = folder_.path() + "/config.toml";
        ENTOPTIC_CHECK(write_overlay(config, {config_file(), folder_.path(), overlay_values(o_, report_path())}));
        const Application application{o_.application, {{"XR_RUNTIME_JSON", manifest}, {"ENTOPTIC_CONFIG", config}}, o_.json};
        const auto ending = run_application(application, [this] { show_progress(); });
        if (!ending) {
            fmt::print(stderr, "entoptic: {}\n", ending.error().message);
            return exit_command_not_found;
        }
        return finish(*ending);
    }

private:
    // `--json` needs the report whether or not a file was asked for.
    std::optional<std::string> report_path() const {
        if (o_.report || !o_.json) return o_.report;
        return folder_.path() + "/report.json";
    }
    Json report_so_far() const {
        const Json report = Json::parse(text_of_file(fs::path(folder_.path()) / progress_file), nullptr, false);
        return report.is_object() && report.contains("frames") ? report : Json();
    }
    void show_progress() {
        const Json so_far = report_so_far();
        if (so_far.is_object()) progress_.update(so_far["frames"].value("displayed", std::uint64_t(0)), o_.frames.value_or(0));
    }
    int finish(const Ending& ending) {
        const std::string why = text_of_file(fs::path(folder_.path()) / failure_file);
        if (!why.empty()) fmt::print(stderr, "entoptic: the runtime failed: {}\n", why);
        if (ending.signalled)
            fmt::print(stderr, "entoptic: the application was ended by signal {} ({}).\n", ending.status - 128,
                       strsignal(ending.status - 128));
        report(why);
        (void)running_runtimes();  // removes what an application that was killed left in the folder of running ones
        return why.empty() ? ending.status : exit_runtime_failed;
    }
    void report(const std::string& why) const {
        const auto path = report_path();
        if (!path) return;
        Json report = Json::parse(text_of_file(*path), nullptr, false);
        if (!report.is_object()) report = report_in_its_place(*path, why);
        if (o_.json) print_json(report);
    }
    // Of an application that ended before its report was written: what it had done up to half a second before.
    Json report_in_its_place(const std::string& path, const std::string& why) const {
        Json report = report_so_far();
        std::string error = why;
        if (why.empty()) {
            error = report.is_object()
                        ? "The application ended before its report was written: these are the figures up to half a second before."
                        : "There is no report: the application never used OpenXR, or ended before it could be written.";
            fmt::print(stderr, "entoptic: {}\n", error);
        }
        if (!report.is_object()) return {{"version", ENTOPTIC_VERSION}, {"errors", {error}}};
        report["errors"].push_back(error);
        if (const auto written = write_json(path, report); !written) fmt::print(stderr, "entoptic: {}\n", written.error().message);
        return report;
    }

    const Options& o_;
    PrivateFolder folder_;
    Progress progress_;
};

Result<int> run(const Options& options) {
    ENTOPTIC_CHECK(check(options));
    ENTOPTIC_TRY(folder, PrivateFolder::create());
    return Run(options, std::move(folder)).start();
}

}  // namespace

void add_run(CLI::App& app, const std::vector<std::string>& application, Action& action) {
    auto o = std::make_shared<Options>();
    CLI::App* c = app.add_subcommand("run", "Run an OpenXR application under this runtime: entoptic run [options] -- CMD...");
    c->add_option("--hmd", o->hmd, "virtual, vive-pro, or replay: a recording given with --script")
        ->check(CLI::IsMember({"virtual", "vive-pro", "replay"}));
    c->add_option("--panel", o->panel, "Pixels of the virtual panel, one eye: 1440x1600");
    c->add_option("--display", o->display, "Readings of the panel: a file in displays/, or a path that ends in .toml");
    c->add_option("--eye-scale", o->eye_scale, "Size of the eye image over the panel's")->check(CLI::Range(0.1, 2.0));
    c->add_option("--clock", o->clock, "real, or lockstep: each frame composed exactly once on a virtual clock")
        ->check(CLI::IsMember({"real", "lockstep"}));
    c->add_option("--script", o->script, "What head, eyes and hands do: a built-in script or a file");
    c->add_option("--frames", o->frames, "End the session after so many displayed frames; one that is under way then is still shown")
        ->check(CLI::Range(std::uint64_t(1), std::uint64_t(1) << 40));
    c->add_option("--dump", o->dump, "Folder for pictures of every frame");
    c->add_option("--dump-stages", o->dump_stages, "Which: warp,perceive,lens,panel,seen")->delimiter(',')->allow_extra_args(false);
    c->add_option("--dump-every", o->dump_every, "Each so many frames")->check(CLI::Range(std::uint64_t(1), std::uint64_t(1) << 40));
    c->add_option("--preset", o->preset, "Preset of effects (entoptic effects lists them)");
    add_repeated(*c, "--model", o->models, "SLOT=NAME or SLOT=none");
    add_repeated(*c, "--set", o->settings, "SLOT.parameter=value");
    c->add_option("--observer", o->observer, "Person whose eye is simulated: observers/NAME.toml");
    c->add_option("--luminance", o->luminance, "cd/m² of linear 1 in layers that do not say")->check(CLI::Range(1e-6, 1e6));
    c->add_option("--report", o->report, "Write the session's report as JSON");
    c->add_option("--target", o->target, "headless, window, kms: the headset's own panel, or auto: a real headset's panel, else a window")
        ->check(CLI::IsMember({"auto", "headless", "window", "kms"}));
    c->add_option("--seed", o->seed, "Seed of everything random");
    c->add_flag("--ideal-tracker", o->ideal_tracker, "Eye tracker without noise, delay and dropouts");
    c->add_flag("--json", o->json, "Print the report on standard output at the end; the application's own goes to standard error");
    c->add_flag("--progress", o->progress, "Tell progress even without a terminal");
    c->callback([o, &application, &action] {
        action = [o, &application] {
            o->application = application;
            o->settings = with_whole_paths(std::move(o->settings));
            tell_twice(o->models, "--model");
            tell_twice(o->settings, "--set");
            return run(*o);
        };
    });
}

}  // namespace entoptic::app
