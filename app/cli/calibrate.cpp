// `entoptic calibrate display`: readings of a light meter to a display's file.
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "app/config.h"
#include "app/display_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <memory>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;

struct DisplayOptions {
    std::string readings, name;
    bool json = false, print_template = false;
};

constexpr const char* eye_names[2] = {"left", "right"};
constexpr int ramp_codes[] = {16, 32, 48, 64, 96, 128, 160, 192, 224};

// A readings file to fill in: -1 is no luminance, so nothing can be forgotten unseen.
int print_template() {
    fmt::print("# Codes to show and what the meter read through the lens. Replace each -1 by the luminance in cd/m2, or by x, y, luminance.\n"
               "instrument = \"\"\n\n");
    for (const char* eye : eye_names) {
        fmt::print("[{}]\nreadings = [\n", eye);
        const auto line = [](int r, int g, int b) { fmt::print("  [{}, {}, {}, -1],\n", r, g, b); };
        line(0, 0, 0);
        for (const int code : ramp_codes) line(code, code, code);
        line(255, 255, 255);
        line(255, 0, 0);
        line(0, 255, 0);
        line(0, 0, 255);
        fmt::print("]\n");
    }
    return 0;
}

double relative(double is, double should) { return is / should - 1; }
std::string percent(std::optional<double> value) { return value && std::isfinite(*value) ? fmt::format("{:+.1f} %", *value * 100) : "-"; }
std::string distance(std::optional<double> duv) { return duv ? fmt::format("{:.4f}", *duv) : "-"; }

void print_check(const char* eye, const DisplayCheck& check) {
    fmt::print("\n{} eye: error of the luminance by the nominal panel, by the fit, and by a fit without this reading\n", eye);
    fmt::print("{:>14} {:>12} {:>10} {:>10} {:>10} {:>14} {:>12}\n", "codes", "cd/m2", "nominal", "fit", "held out", "nominal du'v'", "fit du'v'");
    for (const DisplayCheck::Row& row : check.rows) {
        const auto& [r, g, b] = row.reading.codes;
        const double is = row.reading.luminance_cd_m2;
        fmt::print("{:>14} {:>12.5g} {:>10} {:>10} {:>10} {:>14} {:>12}\n", fmt::format("{},{},{}", r, g, b), is, percent(relative(row.nominal_cd_m2, is)),
                   percent(relative(row.fitted_cd_m2, is)), row.held_out_cd_m2 ? percent(relative(*row.held_out_cd_m2, is)) : "-", distance(row.nominal_duv),
                   distance(row.fitted_duv));
    }
    if (check.additivity)
        fmt::print("White over the sum of its channels: {}{}\n", percent(check.additivity),
                   std::abs(*check.additivity) > 0.05 ? ". The panel's channels are not independent; colours between the readings are less sure." : "");
}

Json check_json(const DisplayCheck& check) {
    Json rows = Json::array();
    const auto optional = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
    for (const DisplayCheck::Row& row : check.rows)
        rows.push_back({{"codes", row.reading.codes},
                        {"measured_cd_m2", row.reading.luminance_cd_m2},
                        {"nominal_cd_m2", row.nominal_cd_m2},
                        {"fitted_cd_m2", row.fitted_cd_m2},
                        {"held_out_cd_m2", optional(row.held_out_cd_m2)},
                        {"nominal_duv", optional(row.nominal_duv)},
                        {"fitted_duv", optional(row.fitted_duv)}});
    return {{"rows", rows}, {"additivity", optional(check.additivity)}};
}

Result<std::string> save(const DisplayOptions& o) {
    const fs::path folder = fs::path(config_folder()) / "displays", path = folder / (o.name + ".toml");
    if (o.name.empty() || o.name.find('/') != std::string::npos) return usage_error("--name is a file's name in displays/, without .toml.");
    std::error_code error;
    fs::create_directories(folder, error);
    if (!fs::equivalent(o.readings, path, error)) fs::copy_file(o.readings, path, fs::copy_options::overwrite_existing, error = {});
    if (error) return failure(fmt::format("Cannot write '{}': {}. Check the folder's permissions.", path.string(), error.message()));
    return path.string();
}

Result<int> calibrate_display(const DisplayOptions& o) {
    if (o.print_template) return print_template();
    if (o.readings.empty()) return usage_error("Name the file with the readings. entoptic calibrate display --template prints one to fill in.");
    ENTOPTIC_TRY(file, read_display_file(o.readings));
    ENTOPTIC_TRY(photometry, measured_photometry(file));
    Json json = {{"white_cd_m2", decimal(photometry.white_cd_m2)}, {"black_cd_m2", decimal(photometry.black_cd_m2)}};
    for (std::size_t eye = 0; eye < 2; ++eye) {
        ENTOPTIC_TRY(check, check_display(file.eyes[eye], Photometry{}));
        json[eye_names[eye]] = check_json(check);
        if (!o.json) print_check(eye_names[eye], check);
    }
    if (!o.json) fmt::print("\nBoth eyes can show D65 white up to {:.5g} cd/m2; the black is {:.4g} cd/m2.\n", photometry.white_cd_m2, photometry.black_cd_m2);
    if (!o.name.empty()) {
        ENTOPTIC_TRY(path, save(o));
        json["file"] = path;
        if (!o.json) fmt::print("Written: {}\nUse it: entoptic run --display {} -- COMMAND, or display = \"{}\" in config.toml.\n", path, o.name, o.name);
    }
    if (o.json) print_json(json);
    return 0;
}

}  // namespace

void add_calibrate(CLI::App& app, Action& action) {
    CLI::App* calibrate = app.add_subcommand("calibrate", "Fit a file to this headset or this person");
    calibrate->require_subcommand(1);
    add_eye_calibration(*calibrate, action);
    auto options = std::make_shared<DisplayOptions>();
    CLI::App* command = calibrate->add_subcommand("display", "Make a display's file of a light meter's readings, and say how well it predicts them");
    command->add_option("readings", options->readings, "TOML file: codes shown and light read (--template prints one to fill in)");
    command->add_option("--name", options->name, "Save it as displays/NAME.toml of the configuration's folder");
    command->add_flag("--template", options->print_template, "Print a file of readings to fill in");
    command->add_flag("--json", options->json, "One JSON document on standard output");
    command->callback([options, &action] { action = [options]() -> Result<int> { return calibrate_display(*options); }; });
}

}  // namespace entoptic::app
