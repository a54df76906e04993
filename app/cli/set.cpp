// `entoptic set`: the preset, models and parameters of a running runtime, and where its wearer's gaze is centred.
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "app/live_settings.h"
#include "app/status_file.h"

#include <chrono>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <thread>
#include <unistd.h>

namespace entoptic::app {
namespace {

using namespace std::chrono_literals;

constexpr auto patience = 5s;  // a runtime looks for requests some twenty times a second
constexpr auto look_every = 20ms;

struct Options {
    LiveChoice choice;
    int pid = 0;
    bool reset = false, recentre_gaze = false, save = false, json = false;
};

std::string name_of(const RunningRuntime& runtime) {
    const auto application = runtime.status.find("application");
    return application != runtime.status.end() && application->is_object() ? application->value("name", "?") : "?";
}

Result<int> chosen_runtime(const Options& o) {
    const std::vector<RunningRuntime> running = running_runtimes();
    std::vector<std::string> names;
    for (const RunningRuntime& runtime : running) {
        if (runtime.pid == o.pid) return runtime.pid;
        names.push_back(fmt::format("{} ({})", runtime.pid, name_of(runtime)));
    }
    if (running.empty()) return failure("No runtime is running. Start one with: entoptic run -- CMD");
    if (o.pid != 0) return failure(fmt::format("No runtime runs in process {}. Running: {}.", o.pid, fmt::join(names, ", ")));
    if (running.size() > 1)
        return usage_error(fmt::format("Several runtimes are running: {}. Choose one with --pid.", fmt::join(names, ", ")));
    return running[0].pid;
}

Result<SettingsAnswer> answer_to(const std::string& id, int pid) {
    const auto until = std::chrono::steady_clock::now() + patience;
    do {
        for (const RunningRuntime& runtime : running_runtimes())
            if (runtime.pid == pid)
                if (const auto answer = answer_of(runtime.status); answer && answer->id == id) return *answer;
        std::this_thread::sleep_for(look_every);
    } while (std::chrono::steady_clock::now() < until);
    return failure(
        fmt::format("The runtime in process {} did not answer within {} s. It may hang, or be of another version.", pid, patience.count()));
}

Result<int> set(const Options& o) {
    if (text_of(o.choice).empty() && !o.reset && !o.recentre_gaze)
        return usage_error(
            "Nothing to set: write SLOT.PARAMETER=VALUE, such as glare.age=70, or --model, --preset, --reset or --recentre-gaze.");
    ENTOPTIC_TRY(pid, chosen_runtime(o));
    const std::string id = fmt::format("{}-{}", getpid(), std::chrono::steady_clock::now().time_since_epoch().count());
    ENTOPTIC_CHECK(leave_request(pid, {id, o.choice, o.reset, o.recentre_gaze, o.save}));
    ENTOPTIC_TRY(answer, answer_to(id, pid));
    if (o.json) {
        Json document = answer_json(answer);
        document["pid"] = pid;
        print_json(document);
    }
    if (!answer.error.empty()) return usage_error(answer.error);
    if (!o.json && !answer.gaze.empty()) fmt::print("{}\n", answer.gaze);
    if (!o.json && (o.reset || !text_of(o.choice).empty()))
        fmt::print("In force in process {}: {}\n", pid,
                   text_of(answer.choice).empty() ? "what it was started with" : text_of(answer.choice));
    return 0;
}

}  // namespace

void add_set(CLI::App& app, Action& action) {
    auto o = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("set", "Change preset, models and parameters, or re-centre the gaze, while a runtime runs");
    command->add_option("settings", o->choice.settings, "SLOT.PARAMETER=VALUE; all of them take effect, or none");
    add_repeated(*command, "--model", o->choice.models, "SLOT=NAME, another model, or none; what the others have in memory stays");
    command->add_option("--preset", o->choice.preset, "Another preset, instead of all that was chosen before");
    command->add_option("--pid", o->pid, "Process of the runtime, when several run (entoptic status)")->check(CLI::PositiveNumber);
    command->add_flag("--reset", o->reset, "Go back to what the runtime was started with first");
    CLI::Option* recentre = command->add_flag("--recentre-gaze", o->recentre_gaze,
                                              "The eye tracker has slipped: the wearer looks straight ahead now (some two metres away)");
    command->add_flag("--save", o->save, "With --recentre-gaze: keep it in the observer's file")->needs(recentre);
    command->add_flag("--json", o->json, "One JSON document on standard output");
    command->callback([o, &action] {
        action = [o] {
            o->choice.settings = with_whole_paths(std::move(o->choice.settings));
            return set(*o);
        };
    });
}

}  // namespace entoptic::app
