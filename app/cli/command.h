// What every command of `entoptic` has in common: how it is declared and how its errors become exit codes.
#pragma once

#include "base/result.h"

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace entoptic::app {

// What a call of `entoptic` asks for: set by the command the user named. Returns the exit code.
using Action = std::function<Result<int>()>;

// Each declares one subcommand. Its options live in the action, which runs after the command line was read without error.
void add_run(CLI::App& app, const std::vector<std::string>& application, Action& action);  // `application`: what stood after `--`
void add_simulate(CLI::App& app, Action& action);
void add_stimulus(CLI::App& app, Action& action);
void add_effects(CLI::App& app, Action& action);
void add_curve(CLI::App& app, Action& action);
void add_set(CLI::App& app, Action& action);
void add_status(CLI::App& app, Action& action);
void add_bench(CLI::App& app, Action& action);
void add_eye(CLI::App& app, Action& action);
void add_calibrate(CLI::App& app, Action& action);
void add_eye_calibration(CLI::App& calibrate, Action& action);  // `calibrate gaze` and `calibrate pupil`
void add_config(CLI::App& app, Action& action);
void add_doctor(CLI::App& app, Action& action);
void add_runtime(CLI::App& app, Action& action);
void add_record(CLI::App& app, Action& action);
void add_replay(CLI::App& app, Action& action);
void add_export(CLI::App& app, Action& action);

// An option that may be given again and again, one value each time: `--model a=b --model c=d`.
CLI::Option* add_repeated(CLI::App& command, const std::string& name, std::vector<std::string>& values, const std::string& help);

// Says on standard error which of `texts` ("slot=model", "slot.parameter=value") name the same thing again: the last counts.
void tell_twice(const std::vector<std::string>& texts, const char* option);
// The settings with files' paths from the root, for a process that works in another folder.
std::vector<std::string> with_whole_paths(std::vector<std::string> settings);

// Runs the action that `arguments` (without the program's name) ask for; everything wrong is said on standard error.
// Exit codes: 0 done, 1 failed, 2 wrong usage, 3 the machine lacks something.
int run_command_line(std::vector<std::string> arguments);

}  // namespace entoptic::app
