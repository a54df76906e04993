#include "app/cli/command.h"

#include "base/log.h"
#include "perception/model.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <set>

namespace entoptic::app {
namespace {

constexpr int exit_usage = 2;

int report(const Error& error) {
    fmt::print(stderr, "entoptic: {}\n", error.message);
    return static_cast<int>(error.kind);
}

// The command that the user named, as far as there is one: `entoptic`, `entoptic eye`, `entoptic eye detect`.
const CLI::App& named_command(const CLI::App& app) {
    const auto named = app.get_subcommands();
    return named.empty() ? app : named_command(*named[0]);
}

int wrong_usage(const CLI::App& app, const std::string& message) {
    std::string words;
    for (const CLI::App* command = &named_command(app); command != &app; command = command->get_parent())
        words = command->get_name() + " " + words;
    fmt::print(stderr, "entoptic: {}\nTry: entoptic {}--help\n", message, words);
    return exit_usage;
}

int parse_and_run(CLI::App& app, std::vector<std::string> arguments, const Action& action) {
    std::reverse(arguments.begin(), arguments.end());  // CLI11 wants them so
    try {
        app.parse(std::move(arguments));
    } catch (const CLI::CallForHelp&) {
        fmt::print("{}", named_command(app).help());
        return 0;
    } catch (const CLI::CallForVersion&) {
        fmt::print("entoptic {}\n", ENTOPTIC_VERSION);
        return 0;
    } catch (const CLI::ParseError& e) { return wrong_usage(app, e.what()); }
    if (!action) return wrong_usage(app, "name a command.");
    const Result<int> outcome = action();
    return outcome ? *outcome : report(outcome.error());
}

}  // namespace

CLI::Option* add_repeated(CLI::App& command, const std::string& name, std::vector<std::string>& values, const std::string& help) {
    return command.add_option(name, values, help)->allow_extra_args(false);
}

void tell_twice(const std::vector<std::string>& texts, const char* option) {
    std::set<std::string> seen, told;
    for (const std::string& text : texts) {
        const std::string name = text.substr(0, text.find('='));
        if (!seen.insert(name).second && told.insert(name).second)
            fmt::print(stderr, "entoptic: {} {} is given more than once; the last one counts.\n", option, name);
    }
}

std::vector<std::string> with_whole_paths(std::vector<std::string> settings) {
    for (std::string& text : settings) {
        const auto dot = text.find('.'), equals = text.find('=');
        if (dot == std::string::npos || equals == std::string::npos || dot > equals || equals + 1 == text.size()) continue;
        const std::string_view whole(text);
        if (!perception::names_file(whole.substr(0, dot), whole.substr(dot + 1, equals - dot - 1))) continue;
        text = text.substr(0, equals + 1) + std::filesystem::absolute(text.substr(equals + 1)).string();
    }
    return settings;
}

int run_command_line(std::vector<std::string> arguments) {
    // What follows `--` is somebody else's command line: it is never looked at.
    const auto dashes = std::find(arguments.begin(), arguments.end(), "--");
    const std::vector<std::string> application(dashes == arguments.end() ? dashes : dashes + 1, arguments.end());
    arguments.erase(dashes, arguments.end());

    CLI::App app("Entoptic: an OpenXR runtime that shows what an eye would see", "entoptic");
    app.set_version_flag("--version", ENTOPTIC_VERSION);
    app.require_subcommand(0, 1);
    Action action;
    add_run(app, application, action);
    add_simulate(app, action);
    add_stimulus(app, action);
    add_effects(app, action);
    add_curve(app, action);
    add_set(app, action);
    add_status(app, action);
    add_bench(app, action);
    add_eye(app, action);
    add_calibrate(app, action);
    add_config(app, action);
    add_doctor(app, action);
    add_runtime(app, action);
    add_record(app, action);
    add_replay(app, action);
    add_export(app, action);
    try {
        return parse_and_run(app, std::move(arguments), action);
    } catch (const std::exception& e) {
        return report({ErrorKind::failed, fmt::format("an unexpected error stopped the command: {}. Please report it.", e.what())});
    }
}

}  // namespace entoptic::app
