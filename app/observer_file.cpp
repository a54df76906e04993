#include "app/observer_file.h"

#include "app/config.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <toml++/toml.h>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> wrong(const std::string& path, const toml::node& node, const std::string& what) {
    return usage_error(fmt::format("{}:{}: {}", path, node.source().begin.line, what));
}

struct PersonSetting {
    std::string slot, parameter;
    double value = 0;
};

Result<std::vector<PersonSetting>> settings_of(const std::string& path, const toml::table& table) {
    std::vector<PersonSetting> out;
    for (const auto& [name, node] : table) {
        if (name == "description" && node.is_string()) continue;
        if (name == "gaze" || name == "pupil") continue;  // observer_calibration.h
        const auto* slots = node.as_table();
        if (name != "settings" || !slots)
            return wrong(path, node, fmt::format("there is no key '{}' of this type. There are: description, [settings], [gaze], [pupil].", name.str()));
        for (const auto& [slot, parameters] : *slots) {
            const auto* values = parameters.as_table();
            if (!values) return wrong(path, parameters, fmt::format("write '{}.PARAMETER = NUMBER'.", slot.str()));
            for (const auto& [parameter, value] : *values) {
                const auto number = value.is_number() ? value.value<double>() : std::nullopt;
                if (!number || !std::isfinite(*number))
                    return wrong(path, value, fmt::format("'{}.{}' must be a number.", slot.str(), parameter.str()));
                out.push_back({std::string(slot.str()), std::string(parameter.str()), *number});
            }
        }
    }
    return out;
}

Result<std::vector<PersonSetting>> parse_observer(const std::string& text, const std::string& path) {
    try {
        return settings_of(path, toml::parse(text, path));
    } catch (const toml::parse_error& e) {
        return usage_error(fmt::format("{}:{}: {}.", path, e.source().begin.line, e.description()));
    }
}

Result<std::vector<PersonSetting>> read_observer(const std::string& name) {
    const fs::path path = fs::path(config_folder()) / "observers" / (name + ".toml");
    if (std::ifstream in(path); in && name.find('/') == std::string::npos)
        return parse_observer({std::istreambuf_iterator<char>(in), {}}, path.string());
    std::vector<std::string_view> known;
    for (const BuiltInObserver& built_in : built_in_observers()) {
        if (name == built_in.name) return parse_observer(built_in.toml, fmt::format("observer {}", name));
        known.emplace_back(built_in.name);
    }
    return usage_error(fmt::format("There is no observer '{}': '{}' cannot be read. Observers that come with the program: {}.", name, path.string(), fmt::join(known, ", ")));
}

// A person's number that the chosen model takes in another range says which file and key asked for it.
Result<void> check_range(const perception::Selection& selection, const PersonSetting& wanted, const std::string& observer) {
    for (const perception::ParameterInfo& p : selection.find(wanted.slot)->entry->parameters)
        if (wanted.parameter == p.name && !p.allows(wanted.value))
            return usage_error(fmt::format("Observer '{}': {}.{} = {} is out of range: {:g} to {:g} {}.", observer, wanted.slot, wanted.parameter, wanted.value, p.min,
                                           p.max, p.unit));
    return {};
}

bool has_parameter(const perception::Selection& selection, const PersonSetting& wanted) {
    const perception::Choice* choice = selection.find(wanted.slot);
    if (!choice) return false;
    const auto list = choice->entry->parameters;
    return std::any_of(list.begin(), list.end(), [&](const perception::ParameterInfo& p) { return wanted.parameter == p.name; });
}

// Without regard to doublings.
Result<perception::Selection> select_for(const std::string& preset, const std::vector<std::string>& models, const std::vector<std::string>& settings,
                                         const std::string& observer) {
    if (observer.empty()) return perception::select(preset, models, settings);
    ENTOPTIC_TRY(person, read_observer(observer));
    ENTOPTIC_TRY(chosen, perception::select(preset, models, {}));
    std::vector<std::string> all;
    for (const PersonSetting& s : person)
        if (has_parameter(chosen, s)) {
            ENTOPTIC_CHECK(check_range(chosen, s, observer));
            all.push_back(fmt::format("{}.{}={}", s.slot, s.parameter, s.value));
        }
    all.insert(all.end(), settings.begin(), settings.end());
    return perception::select(preset, models, all);
}

}  // namespace

Result<perception::Selection> select_effects(const std::string& preset, const std::vector<std::string>& models,
                                             const std::vector<std::string>& settings, const std::string& observer, perception::Viewer viewer) {
    ENTOPTIC_TRY(selection, select_for(preset, models, settings, observer));
    ENTOPTIC_CHECK(perception::expect_no_doubling(selection, viewer));
    return selection;
}

}  // namespace entoptic::app
