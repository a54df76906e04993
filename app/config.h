// The configuration: TOML files checked against one table of keys, where every value knows where it came from.
//
// Later ones win: defaults, config.toml, the application's profile, the command line of `entoptic run`.
#pragma once

#include "base/result.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace entoptic::app {

template <class T> struct Setting {
    T value{};
    std::string origin = "default";  // "default", "/home/u/.config/entoptic/config.toml:3", "command line"
};

struct Config {
    Setting<std::string> hmd{"virtual"};
    Setting<std::string> eye_tracker{"auto"};          // auto | headset | pupil-labs
    Setting<std::pair<int, int>> panel{{1440, 1600}};  // pixels of one eye
    Setting<double> eye_scale{1};                      // eye image over panel
    Setting<double> ipd_mm{63};
    Setting<std::string> display;        // a file in displays/ or a path; empty: a nominal panel
    Setting<std::string> clock{"real"};  // real | lockstep
    Setting<std::string> script{"still"};
    Setting<bool> ideal_tracker{false};
    Setting<std::uint64_t> seed{1};
    Setting<std::string> target{"auto"};  // auto | headless | window | kms
    Setting<std::uint64_t> frames{0};     // displayed frames after which the session ends; 0: no limit
    Setting<std::string> preset;
    Setting<std::string> observer;               // a person's file in observers/; empty: the default eye
    std::vector<Setting<std::string>> models;    // "glare=none"
    std::vector<Setting<std::string>> settings;  // "glare.k=8"
    Setting<std::optional<double>> luminance;    // cd/m² of linear 1 in layers that do not say
    Setting<std::vector<std::string>> quirks;    // of quirk_names
    Setting<std::string> dump_dir;               // empty: no dumps
    Setting<std::vector<std::string>> dump_stages{{"panel"}};
    Setting<std::uint64_t> dump_every{1};
    Setting<std::string> report;         // empty: no report
    Setting<std::string> vulkan_device;  // part of a device's name; empty: the best there is
    Setting<bool> vulkan_validation{false};
    Setting<std::string> launcher_directory;  // private folder of the `entoptic run` that started this process

    Config();
    std::vector<std::string> model_names() const;  // values only
    std::vector<std::string> setting_texts() const;
};

inline const std::vector<std::string> dump_stage_names{"warp", "perceive", "lens", "panel", "seen"};

// Mistakes of applications that can be made up for: interfaces/runtime_host.h, Quirks.
inline const std::vector<std::string> quirk_names{"untyped_arrays"};

// Profiles of applications that are known to need one; those in applications/*.toml come after them.
struct BuiltInProfile {
    const char* name;
    const char* toml;  // as a file would hold it, with the reason
};
std::span<const BuiltInProfile> built_in_profiles();

// Who asks for the configuration: chooses a profile from applications/*.toml.
struct ApplicationNames {
    std::string application, engine;
};

// $XDG_CONFIG_HOME/entoptic, else ~/.config/entoptic.
std::string config_folder();
// The file that counts: ENTOPTIC_CONFIG, else config.toml of the folder; empty when there is none.
std::string config_file();

// Everything above, in order. Errors name the file, the line, the key and what is allowed.
// `application`: none leaves profiles out.
Result<Config> load_config(const std::optional<ApplicationNames>& application);

// One file over what is in `config`, as config.toml would be read. For tests and for `load_config`.
Result<void> read_config_file(const std::string& path, Config& config);

// What `entoptic run` hands to the runtime: the values that came from its command line, over the configuration that was in force.
struct Overlay {
    std::string base_file;  // config_file() of the caller; may be empty
    std::string directory;  // launcher_directory
    // Keys as in the files, with values in TOML: {"panel", "\"320x360\""}, {"dump.every", "10"}. Slots' models and settings go in
    // "models" and "settings" as inline tables.
    std::vector<std::pair<std::string, std::string>> values;
};
Result<void> write_overlay(const std::string& path, const Overlay& overlay);

// An error about a model or setting that a file of the configuration chose, with that file and line before it.
Error with_origin(Error error, const Config& config);

// Text as a TOML string, quoted.
std::string toml_string(const std::string& text);

// For `entoptic config`: every key with its value, its origin and what is allowed.
struct ConfigLine {
    std::string key, value, origin, allowed, meaning;
};
std::vector<ConfigLine> describe(const Config& config);

}  // namespace entoptic::app
