#include "app/config.h"

#include "app/parse.h"
#include "perception/preset.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>
#include <fstream>
#include <set>
#include <toml++/toml.h>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;

// ---- One table of keys -------------------------------------------------------------------------------------------------------

// Where a file's values are said to come from; `command_line` files are written by `entoptic run`.
struct Source {
    std::string path;
    bool command_line = false;
    std::string origin(const toml::node& node) const {
        return command_line ? "command line" : fmt::format("{}:{}", path, node.source().begin.line);
    }
};

using Reader = bool (*)(const toml::node&, const Source&, Config&);  // false: not what is allowed
struct Key {
    const char *name, *allowed, *meaning;
    bool profile;  // an application's profile may set it
    Reader read;
    std::string (*show)(const Config&);
    std::string (*origin)(const Config&);
};

template <class T> bool set(Setting<T>& setting, T value, const toml::node& node, const Source& source) {
    setting = {std::move(value), source.origin(node)};
    return true;
}
bool read_text(const toml::node& node, const Source& source, Setting<std::string>& into,
               std::initializer_list<std::string_view> choices = {}) {
    const auto text = node.value_exact<std::string>();
    if (!text || (choices.size() > 0 && std::find(choices.begin(), choices.end(), *text) == choices.end())) return false;
    return set(into, *text, node, source);
}
bool read_flag(const toml::node& node, const Source& source, Setting<bool>& into) {
    const auto flag = node.value_exact<bool>();
    return flag && set(into, *flag, node, source);
}
bool read_count(const toml::node& node, const Source& source, Setting<std::uint64_t>& into, std::int64_t least) {
    const auto number = node.value_exact<std::int64_t>();
    return number && *number >= least && set(into, static_cast<std::uint64_t>(*number), node, source);
}
std::optional<double> number_in(const toml::node& node, double low, double high) {
    if (!node.is_number()) return std::nullopt;
    const auto number = node.value<double>();
    return number && *number >= low && *number <= high ? number : std::nullopt;
}
bool read_number(const toml::node& node, const Source& source, Setting<double>& into, double low, double high) {
    const auto number = number_in(node, low, high);
    return number && set(into, *number, node, source);
}
bool read_panel(const toml::node& node, const Source& source, Config& c) {
    const auto text = node.value_exact<std::string>();
    const auto size = text ? size_from(*text) : std::nullopt;
    if (!size || size->first < 16 || size->second < 16 || size->first > 8192 || size->second > 8192) return false;
    return set(c.panel, *size, node, source);
}
bool read_preset(const toml::node& node, const Source& source, Config& c) {
    // Another preset starts afresh: what files below chose for the old one does not fit it.
    if (!read_text(node, source, c.preset)) return false;
    c.models.clear();
    c.settings.clear();
    return true;
}
bool read_models(const toml::node& node, const Source& source, Config& c) {
    const auto* table = node.as_table();
    if (!table) return false;
    for (const auto& [slot, model] : *table) {
        const auto name = model.value_exact<std::string>();
        if (!name) return false;
        c.models.push_back({fmt::format("{}={}", slot.str(), *name), source.origin(model)});
    }
    return true;
}
bool read_settings(const toml::node& node, const Source& source, Config& c) {
    const auto* slots = node.as_table();
    if (!slots) return false;
    for (const auto& [slot, parameters] : *slots) {
        const auto* table = parameters.as_table();
        if (!table) return false;
        for (const auto& [name, value] : *table) {
            const bool is_word = perception::names_file(slot.str(), name.str()) || (slot == "foveation" && name == "inverse");
            const auto word = is_word ? value.value_exact<std::string>() : std::nullopt;
            const auto number = value.is_number() ? value.value<double>() : std::nullopt;
            if (!word && (!number || !std::isfinite(*number))) return false;
            const bool is_path = word && slot != "foveation" && !word->empty();
            const std::string text = !word     ? fmt::format("{}", *number)
                                     : is_path ? (fs::absolute(source.path).parent_path() / *word).string()
                                               : *word;
            c.settings.push_back({fmt::format("{}.{}={}", slot.str(), name.str(), text), source.origin(value)});
        }
    }
    return true;
}
bool read_luminance(const toml::node& node, const Source& source, Config& c) {
    const auto number = number_in(node, 1e-6, 1e6);
    return number && set(c.luminance, std::optional<double>(number), node, source);
}
bool read_names(const toml::node& node, const Source& source, const std::vector<std::string>& known,
                Setting<std::vector<std::string>>& into) {
    const auto* array = node.as_array();
    if (!array) return false;
    std::vector<std::string> names;
    for (const auto& item : *array) {
        const auto name = item.value_exact<std::string>();
        if (!name || std::find(known.begin(), known.end(), *name) == known.end()) return false;
        names.push_back(*name);
    }
    return set(into, std::move(names), node, source);
}

std::string shown(const std::string& text) { return text.empty() ? "(none)" : text; }
std::string joined(const std::vector<Setting<std::string>>& list) {
    std::vector<std::string> texts;
    for (const auto& item : list) texts.push_back(item.value);
    return shown(fmt::format("{}", fmt::join(texts, ", ")));
}
std::string origins(const std::vector<Setting<std::string>>& list) {
    std::vector<std::string> texts;
    for (const auto& item : list)
        if (texts.empty() || texts.back() != item.origin) texts.push_back(item.origin);
    return list.empty() ? "default" : fmt::format("{}", fmt::join(texts, ", "));
}

using N = const toml::node&;
using S = const Source&;
#define ENTOPTIC_ORIGIN(member) [](const Config& c) { return c.member.origin; }
const Key keys[] = {
    {"hmd", "\"virtual\", \"vive-pro\" or \"replay\"", "the headset; replay: a recording, named by script", false,
     [](N n, S s, Config& c) {
         return read_text(n, s, c.hmd, {"virtual", "vive-pro", "replay"});
     },
     [](const Config& c) { return c.hmd.value; }, ENTOPTIC_ORIGIN(hmd)},
    {"eye_tracker", "\"auto\", \"headset\" or \"pupil-labs\"",
     "who watches the eyes; auto: the virtual headset's own, else eye cameras, else the headset's", false,
     [](N n, S s, Config& c) {
         return read_text(n, s, c.eye_tracker, {"auto", "headset", "pupil-labs"});
     },
     [](const Config& c) { return c.eye_tracker.value; }, ENTOPTIC_ORIGIN(eye_tracker)},
    {"panel", "\"WIDTHxHEIGHT\", each 16 to 8192", "pixels of the virtual panel, one eye", false, read_panel,
     [](const Config& c) { return fmt::format("{}x{}", c.panel.value.first, c.panel.value.second); }, ENTOPTIC_ORIGIN(panel)},
    {"eye_scale", "a number from 0.1 to 2", "size of the eye image over the panel's", true,
     [](N n, S s, Config& c) { return read_number(n, s, c.eye_scale, 0.1, 2); },
     [](const Config& c) { return fmt::format("{:g}", c.eye_scale.value); }, ENTOPTIC_ORIGIN(eye_scale)},
    {"ipd_mm", "a number from 50 to 80", "distance between the eyes", false,
     [](N n, S s, Config& c) { return read_number(n, s, c.ipd_mm, 50, 80); },
     [](const Config& c) { return fmt::format("{:g}", c.ipd_mm.value); }, ENTOPTIC_ORIGIN(ipd_mm)},
    {"display", "the name of a file in displays/, without .toml, or a path that ends in it", "readings of the headset's panel", false,
     [](N n, S s, Config& c) { return read_text(n, s, c.display); }, [](const Config& c) { return shown(c.display.value); },
     ENTOPTIC_ORIGIN(display)},
    {"clock", "\"real\" or \"lockstep\"", "lockstep: a virtual clock, each frame composed exactly once", false,
     [](N n, S s, Config& c) {
         return read_text(n, s, c.clock, {"real", "lockstep"});
     },
     [](const Config& c) { return c.clock.value; }, ENTOPTIC_ORIGIN(clock)},
    {"script", "a script's name or a file", "what the virtual head, eyes and hands do", false,
     [](N n, S s, Config& c) { return read_text(n, s, c.script); }, [](const Config& c) { return c.script.value; },
     ENTOPTIC_ORIGIN(script)},
    {"ideal_tracker", "true or false", "virtual eye tracker without noise, delay and dropouts", false,
     [](N n, S s, Config& c) { return read_flag(n, s, c.ideal_tracker); },
     [](const Config& c) { return fmt::format("{}", c.ideal_tracker.value); }, ENTOPTIC_ORIGIN(ideal_tracker)},
    {"seed", "a whole number from 0", "seed of everything random", false, [](N n, S s, Config& c) { return read_count(n, s, c.seed, 0); },
     [](const Config& c) { return fmt::format("{}", c.seed.value); }, ENTOPTIC_ORIGIN(seed)},
    {"target", "\"auto\", \"headless\", \"window\" or \"kms\"",
     "where pictures go; kms: the headset's own panel; auto: a real headset's panel, else a window; the virtual one's nowhere", false,
     [](N n, S s, Config& c) {
         return read_text(n, s, c.target, {"auto", "headless", "window", "kms"});
     },
     [](const Config& c) { return c.target.value; }, ENTOPTIC_ORIGIN(target)},
    {"frames", "a whole number from 0", "displayed frames after which the session ends; 0: no limit", false,
     [](N n, S s, Config& c) { return read_count(n, s, c.frames, 0); }, [](const Config& c) { return fmt::format("{}", c.frames.value); },
     ENTOPTIC_ORIGIN(frames)},
    {"preset", "a preset's name (entoptic effects lists them)", "which effects are on", true, read_preset,
     [](const Config& c) { return c.preset.value; }, ENTOPTIC_ORIGIN(preset)},
    {"observer", "the name of a file in observers/, without .toml", "whose eye is simulated", true,
     [](N n, S s, Config& c) { return read_text(n, s, c.observer); }, [](const Config& c) { return shown(c.observer.value); },
     ENTOPTIC_ORIGIN(observer)},
    {"models", "a table of slot = \"model\"", "other models than the preset's", true, read_models,
     [](const Config& c) { return joined(c.models); }, [](const Config& c) { return origins(c.models); }},
    {"settings", "a table of slot.parameter = number, = \"path\" for a file, or foveation.inverse = \"off\", \"exact\" or \"fitted\"",
     "other parameters than the preset's", true, read_settings, [](const Config& c) { return joined(c.settings); },
     [](const Config& c) { return origins(c.settings); }},
    {"luminance", "a number from 1e-6 to 1e6", "cd/m² of linear 1 in layers that do not say; default: the panel's white", true,
     read_luminance, [](const Config& c) { return c.luminance.value ? fmt::format("{:g}", *c.luminance.value) : "(the panel's white)"; },
     ENTOPTIC_ORIGIN(luminance)},
    {"quirks", "an array of \"untyped_arrays\"", "mistakes of the application that the runtime makes up for", true,
     [](N n, S s, Config& c) { return read_names(n, s, quirk_names, c.quirks); },
     [](const Config& c) { return shown(fmt::format("{}", fmt::join(c.quirks.value, ", "))); }, ENTOPTIC_ORIGIN(quirks)},
    {"dump.dir", "a folder", "where pictures of every frame are written", false,
     [](N n, S s, Config& c) { return read_text(n, s, c.dump_dir); }, [](const Config& c) { return shown(c.dump_dir.value); },
     ENTOPTIC_ORIGIN(dump_dir)},
    {"dump.stages", "an array of \"warp\", \"perceive\", \"lens\", \"panel\", \"seen\"", "which pictures", false,
     [](N n, S s, Config& c) { return read_names(n, s, dump_stage_names, c.dump_stages); },
     [](const Config& c) { return fmt::format("{}", fmt::join(c.dump_stages.value, ", ")); }, ENTOPTIC_ORIGIN(dump_stages)},
    {"dump.every", "a whole number from 1", "dump each so many frames", false,
     [](N n, S s, Config& c) { return read_count(n, s, c.dump_every, 1); },
     [](const Config& c) { return fmt::format("{}", c.dump_every.value); }, ENTOPTIC_ORIGIN(dump_every)},
    {"report", "a file", "where the report is written when the session ends", false,
     [](N n, S s, Config& c) { return read_text(n, s, c.report); }, [](const Config& c) { return shown(c.report.value); },
     ENTOPTIC_ORIGIN(report)},
    {"vulkan.device", "part of a device's name", "the device to compute on", false,
     [](N n, S s, Config& c) { return read_text(n, s, c.vulkan_device); }, [](const Config& c) { return shown(c.vulkan_device.value); },
     ENTOPTIC_ORIGIN(vulkan_device)},
    {"vulkan.validation", "true or false", "run under the Khronos validation layer", false,
     [](N n, S s, Config& c) { return read_flag(n, s, c.vulkan_validation); },
     [](const Config& c) { return fmt::format("{}", c.vulkan_validation.value); }, ENTOPTIC_ORIGIN(vulkan_validation)},
};
#undef ENTOPTIC_ORIGIN

// ---- Reading ---------------------------------------------------------------------------------------------------------------------

std::string key_names(bool profile) {
    std::vector<std::string> names;
    for (const Key& key : keys)
        if (!profile || key.profile) names.emplace_back(key.name);
    return fmt::format("{}", fmt::join(names, ", "));
}

tl::unexpected<Error> wrong(const Source& source, const toml::node& node, const std::string& what) {
    return usage_error(fmt::format("{}:{}: {}", source.path, node.source().begin.line, what));
}

struct Walk {
    const Source& source;
    bool profile = false;        // only the keys that a profile may set
    std::set<std::string> skip;  // tables that somebody else reads

    Result<void> table(const toml::table& in, const std::string& prefix, Config& config) const {
        for (const auto& [name, node] : in) {
            const std::string key = prefix + std::string(name.str());
            if (skip.count(key) > 0) continue;
            const auto found =
                std::find_if(std::begin(keys), std::end(keys), [&](const Key& k) { return k.name == key && (!profile || k.profile); });
            if (found != std::end(keys)) {
                if (!found->read(node, source, config)) return wrong(source, node, fmt::format("'{}' must be {}.", key, found->allowed));
            } else if (const auto* inner = node.as_table(); inner && has_keys_below(key)) {
                ENTOPTIC_CHECK(table(*inner, key + ".", config));
            } else {
                return wrong(
                    source, node,
                    fmt::format("there is no key '{}'{}. There are: {}.", key, profile ? " in a profile" : "", key_names(profile)));
            }
        }
        return {};
    }
    static bool has_keys_below(const std::string& key) {
        return std::any_of(std::begin(keys), std::end(keys), [&](const Key& k) { return std::string_view(k.name).starts_with(key + "."); });
    }
};

Result<toml::table> parse(const std::string& path) {
    std::ifstream in(path);
    if (!in || fs::is_directory(path)) return failure(fmt::format("Cannot read '{}'. Check the name and the permissions.", path));
    try {
        return toml::parse(in, path);
    } catch (const toml::parse_error& e) { return usage_error(fmt::format("{}:{}: {}.", path, e.source().begin.line, e.description())); }
}

// A preset goes first whatever the order of lines: it clears what the models and settings of the same file then set.
Result<void> read_preset_first(const toml::table& table, const Source& source, Config& config) {
    const auto* preset = table.get("preset");
    if (preset && !read_preset(*preset, source, config))
        return wrong(source, *preset, "'preset' must be a preset's name (entoptic effects lists them).");
    return {};
}

Result<void> read_table(const toml::table& table, const Source& source, Config& config, std::set<std::string> skip, bool profile = false) {
    skip.insert("preset");
    ENTOPTIC_CHECK(read_preset_first(table, source, config));
    return Walk{source, profile, std::move(skip)}.table(table, "", config);
}

// `pattern` may hold * and ?; an absent one matches.
bool matches(const toml::node* pattern, const std::string& name) {
    if (!pattern) return true;
    return fnmatch(pattern->value_or(std::string()).c_str(), name.c_str(), 0) == 0;
}

Result<void> read_profile(const toml::table& table, const std::string& path, const ApplicationNames& application, Config& config) {
    const Source source{path, false};
    const auto* match = table["match"].as_table();
    if (!match || match->empty())
        return usage_error(fmt::format("{}: a profile needs a table [match] with 'application' or 'engine'.", path));
    for (const auto& [name, node] : *match) {
        if (name != "application" && name != "engine")
            return wrong(source, node, fmt::format("there is no key 'match.{}'. There are: match.application, match.engine.", name.str()));
        if (!node.is_string())
            return wrong(source, node, fmt::format("'match.{}' must be a name; * and ? stand for any letters.", name.str()));
    }
    if (!matches(match->get("application"), application.application) || !matches(match->get("engine"), application.engine)) return {};
    return read_table(table, source, config, {"match"}, true);
}

Result<void> read_profiles(const ApplicationNames& application, Config& config) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(fs::path(config_folder()) / "applications", error))
        if (entry.path().extension() == ".toml") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const BuiltInProfile& profile : built_in_profiles())
        ENTOPTIC_CHECK(read_profile(toml::parse(profile.toml), fmt::format("built-in profile {}", profile.name), application, config));
    for (const auto& file : files) {
        ENTOPTIC_TRY(table, parse(file));
        ENTOPTIC_CHECK(read_profile(table, file, application, config));
    }
    return {};
}

std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

}  // namespace

Config::Config() { preset.value = perception::default_preset; }

std::vector<std::string> Config::model_names() const {
    std::vector<std::string> out;
    for (const auto& item : models) out.push_back(item.value);
    return out;
}

std::vector<std::string> Config::setting_texts() const {
    std::vector<std::string> out;
    for (const auto& item : settings) out.push_back(item.value);
    return out;
}

std::string config_folder() {
    const std::string xdg = environment("XDG_CONFIG_HOME"), home = environment("HOME");
    return fs::path(!xdg.empty() && xdg[0] == '/' ? fs::path(xdg) : fs::path(home) / ".config") / "entoptic";
}

std::string config_file() {
    if (const std::string named = environment("ENTOPTIC_CONFIG"); !named.empty()) return named;
    const fs::path path = fs::path(config_folder()) / "config.toml";
    std::error_code error;
    return fs::exists(path, error) ? path.string() : "";
}

Result<void> read_config_file(const std::string& path, Config& config) {
    ENTOPTIC_TRY(table, parse(path));
    return read_table(table, {path, false}, config, {});
}

Result<Config> load_config(const std::optional<ApplicationNames>& application) {
    Config config;
    const std::string file = config_file();
    toml::table table;
    if (!file.empty()) {
        ENTOPTIC_TRY(parsed, parse(file));
        table = std::move(parsed);
    }
    const bool overlay = table["launcher"].is_table();
    const std::string base = overlay ? table["launcher"]["base"].value_or(std::string()) : file;
    if (!base.empty()) ENTOPTIC_CHECK(read_config_file(base, config));
    if (application) ENTOPTIC_CHECK(read_profiles(*application, config));
    if (!overlay) return config;
    ENTOPTIC_CHECK(read_table(table, {file, true}, config, {"launcher"}));
    config.launcher_directory = {table["launcher"]["directory"].value_or(std::string()), "command line"};
    return config;
}

Error with_origin(Error error, const Config& config) {
    for (const auto* list : {&config.settings, &config.models})
        for (const Setting<std::string>& item : *list) {
            const std::string name = item.value.substr(0, item.value.find('='));
            const bool is_model = list == &config.models;
            if (item.origin == "command line" || item.origin == "default" ||
                error.message.find(is_model ? item.value : name) == std::string::npos)
                continue;
            error.message = fmt::format("{}: {}", item.origin, error.message);
            return error;
        }
    return error;
}

std::string toml_string(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            out += fmt::format("\\{}", c);
        else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            out += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
        else
            out += c;
    }
    return out + "\"";
}

Result<void> write_overlay(const std::string& path, const Overlay& overlay) {
    std::ofstream out(path, std::ios::trunc);
    out << "# Written by `entoptic run` for the application it starts; removed when that ends.\n";
    for (const auto& [key, value] : overlay.values) out << key << " = " << value << '\n';
    out << "[launcher]\nbase = " << toml_string(overlay.base_file) << "\ndirectory = " << toml_string(overlay.directory) << '\n';
    out.close();
    if (!out) return failure(fmt::format("Cannot write '{}'. Check that there is room.", path));
    return {};
}

std::vector<ConfigLine> describe(const Config& config) {
    std::vector<ConfigLine> lines;
    for (const Key& key : keys) lines.push_back({key.name, key.show(config), key.origin(config), key.allowed, key.meaning});
    return lines;
}

}  // namespace entoptic::app
