// `entoptic config`: the configuration in force, and where each value came from.
#include "app/config.h"
#include "app/cli/command.h"
#include "app/cli/output.h"

#include <fmt/format.h>
#include <memory>

namespace entoptic::app {
namespace {

struct Options {
    bool json = false;
    std::string application, engine;
};

Json config_json(const Config& config) {
    Json values = Json::array();
    for (const ConfigLine& line : describe(config))
        values.push_back(
            {{"key", line.key}, {"value", line.value}, {"origin", line.origin}, {"allowed", line.allowed}, {"meaning", line.meaning}});
    return {{"file", config_file()}, {"folder", config_folder()}, {"values", values}};
}

void print_table(const Config& config) {
    const std::string file = config_file();
    fmt::print("Configuration: {}\n\n", file.empty() ? fmt::format("none (would be {}/config.toml)", config_folder()) : file);
    for (const ConfigLine& line : describe(config)) fmt::print("  {:<18} {:<28} {}\n", line.key, line.value, line.origin);
}

Result<int> show(const Options& options) {
    std::optional<ApplicationNames> application;
    if (!options.application.empty() || !options.engine.empty()) application = {options.application, options.engine};
    ENTOPTIC_TRY(config, load_config(application));
    if (options.json)
        print_json(config_json(config));
    else
        print_table(config);
    return 0;
}

}  // namespace

void add_config(CLI::App& app, Action& action) {
    auto o = std::make_shared<Options>();
    CLI::App* c = app.add_subcommand("config", "Show the configuration and where each value came from");
    c->add_flag("--json", o->json, "One JSON document on standard output");
    c->add_option("--application", o->application, "As an application of this name would get it, with its profile");
    c->add_option("--engine", o->engine, "As an application made with this engine would get it");
    c->callback([o, &action] { action = [o] { return show(*o); }; });
}

}  // namespace entoptic::app
