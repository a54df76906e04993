// `entoptic runtime`: makes this the user's active OpenXR runtime, and takes it back.
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "app/launch.h"
#include "app/system/active_runtime.h"

#include <fmt/format.h>
#include <memory>

namespace entoptic::app {
namespace {

Result<int> set_runtime() {
    ENTOPTIC_TRY(manifest, find_manifest());
    const ActiveRuntime runtime = ActiveRuntime::of_user();
    ENTOPTIC_CHECK(runtime.set(manifest));
    fmt::print("Applications of this user now run on Entoptic ({}). Undo: entoptic runtime restore\n", runtime.user_file());
    if (const RuntimeChoice now = runtime.current(manifest); !now.ours)
        return failure(
            fmt::format("{} comes before it and names another runtime ({}). Remove it, or unset XR_RUNTIME_JSON.", now.file, now.library));
    return 0;
}

Result<int> restore_runtime() {
    ENTOPTIC_TRY(manifest, find_manifest());
    ENTOPTIC_TRY(changed, ActiveRuntime::of_user().restore(manifest));
    fmt::print("{}\n", changed ? "The runtime from before is active again." : "Entoptic was not the active runtime. Nothing was changed.");
    return 0;
}

Result<int> show_runtime(bool json) {
    ENTOPTIC_TRY(manifest, find_manifest());
    const RuntimeChoice now = ActiveRuntime::of_user().current(manifest);
    if (json)
        print_json({{"active", now.ours},
                    {"file", now.file},
                    {"manifest", now.target},
                    {"library", now.library},
                    {"source", now.source},
                    {"entoptic", manifest}});
    else if (now.file.empty())
        fmt::print("No OpenXR runtime is active. Make it this one: entoptic runtime set\n");
    else
        fmt::print("{}: {}, by {} ({})\n", now.ours ? "Active: Entoptic" : "Active: another runtime",
                   now.library.empty() ? "its manifest cannot be read" : now.library, now.source, now.file);
    return 0;
}

}  // namespace

void add_runtime(CLI::App& app, Action& action) {
    auto json = std::make_shared<bool>(false);
    CLI::App* command = app.add_subcommand("runtime", "Make this the user's active OpenXR runtime, or undo it");
    command->require_subcommand(1);
    command->add_subcommand("set", "Make it the active one; what was active is kept")->callback([&action] { action = set_runtime; });
    command->add_subcommand("restore", "Make active again what was before")->callback([&action] { action = restore_runtime; });
    CLI::App* status = command->add_subcommand("status", "Which one applications get, and why");
    status->add_flag("--json", *json, "One JSON document on standard output");
    status->callback([json, &action] { action = [json] { return show_runtime(*json); }; });
}

}  // namespace entoptic::app
