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

using ParameterList = std::vector<const perception::ParameterInfo*>;

// This parameter of every model of the slot that has it.
ParameterList parameters_named(std::string_view slot, std::string_view name) {
    ParameterList list;
    for (const perception::ModelEntry* entry : perception::models())
        for (const perception::ParameterInfo& p : entry->parameters)
            if (entry->slot == slot && name == p.name) list.push_back(&p);
    return list;
}

std::string ranges_of(const ParameterList& list) {
    std::vector<std::string> texts;
    for (const perception::ParameterInfo* p : list)
        if (const std::string text = range_text(*p); std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
    return fmt::format("{}", fmt::join(texts, ", or "));
}

Result<double> value_of(const std::string& path, const toml::node& node, std::string_view slot, std::string_view name) {
    const auto slots = perception::slots();
    if (std::find(slots.begin(), slots.end(), slot) == slots.end())
        return wrong(path, node, fmt::format("there is no slot '{}'. Slots: {}.", slot, fmt::join(slots, ", ")));
    const ParameterList known = parameters_named(slot, name);
    if (known.empty())
        return wrong(path, node,
                     fmt::format("no model of the slot '{}' has a parameter '{}'. `entoptic effects` lists what there is.", slot, name));
    const auto number = node.is_number() ? node.value<double>() : std::nullopt;
    if (!number) return wrong(path, node, fmt::format("'{}.{}' must be a number: {}.", slot, name, ranges_of(known)));
    if (std::none_of(known.begin(), known.end(), [&](const auto* p) { return p->allows(*number); }))
        return wrong(path, node, fmt::format("{}.{} = {} is out of range: {}.", slot, name, *number, ranges_of(known)));
    return *number;
}

Result<std::vector<PersonSetting>> settings_of(const std::string& path, const toml::table& table) {
    std::vector<PersonSetting> out;
    for (const auto& [name, node] : table) {
        if (name == "description" && node.is_string()) continue;
        if (name == "gaze" || name == "pupil") continue;  // add_measured_pupils(), and observer_calibration.h
        const auto* slots = node.as_table();
        if (name != "settings" || !slots)
            return wrong(path, node, fmt::format("there is no key '{}' of this type. There are: description, [settings], [gaze], [pupil].", name.str()));
        for (const auto& [slot, parameters] : *slots) {
            const auto* values = parameters.as_table();
            if (!values) return wrong(path, parameters, fmt::format("write '{}.PARAMETER = NUMBER'.", slot.str()));
            for (const auto& [parameter, value] : *values) {
                ENTOPTIC_TRY(number, value_of(path, value, slot.str(), parameter.str()));
                out.push_back({std::string(slot.str()), std::string(parameter.str()), number});
            }
        }
    }
    return out;
}

// What `entoptic calibrate pupil` measured in front of a white and of a black display is what luidolt_pupil asks for, unless the file says
// otherwise. observer_calibration.h refuses what cannot be.
void add_measured_pupils(const toml::table& table, std::vector<PersonSetting>& person) {
    for (const auto& [measured, parameter] : {std::pair{"narrowest_mm", "white_mm"}, std::pair{"widest_mm", "black_mm"}}) {
        const auto mm = table["pupil"][measured].value<double>();
        const ParameterList known = parameters_named("pupil", parameter);
        const bool said =
            std::any_of(person.begin(), person.end(), [&](const auto& s) { return s.slot == "pupil" && s.parameter == parameter; });
        if (!said && mm && !known.empty() && known[0]->allows(*mm)) person.push_back({"pupil", parameter, *mm});
    }
}

Result<std::vector<PersonSetting>> parse_observer(const std::string& text, const std::string& path) {
    try {
        const toml::table table = toml::parse(text, path);
        ENTOPTIC_TRY(person, settings_of(path, table));
        add_measured_pupils(table, person);
        return person;
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

// A person's number that the chosen model takes in another range than the slot's other models says which observer and key asked for it.
Result<void> check_range(const perception::Selection& selection, const PersonSetting& wanted, const std::string& observer) {
    const perception::ModelEntry& entry = *selection.find(wanted.slot)->entry;
    for (const perception::ParameterInfo& p : entry.parameters)
        if (wanted.parameter == p.name && !p.allows(wanted.value))
            return usage_error(fmt::format("Observer '{}': {}.{} = {} is out of range of the model {}: {}.", observer, wanted.slot,
                                           wanted.parameter, wanted.value, entry.name, range_text(p)));
    return {};
}

bool has_parameter(const perception::Selection& selection, const PersonSetting& wanted) {
    const perception::Choice* choice = selection.find(wanted.slot);
    if (!choice) return false;
    const auto list = choice->entry->parameters;
    return std::any_of(list.begin(), list.end(), [&](const perception::ParameterInfo& p) { return wanted.parameter == p.name; });
}

// Who looks at the display, where a person's file does not say: the mean eye that the person's numbers are compared with (CIE 146:2002; the
// models' defaults for the person).
const PersonSetting mean_wearer[] = {
    {"glare", "wearer_age", 30}, {"glare", "wearer_pigment", 0.5}, {"glare", "wearer_straylight_factor", 1}};

std::vector<PersonSetting> with_wearer(std::vector<PersonSetting> person) {
    for (const PersonSetting& mean : mean_wearer)
        if (std::none_of(person.begin(), person.end(),
                         [&](const PersonSetting& s) { return s.slot == mean.slot && s.parameter == mean.parameter; }))
            person.push_back(mean);
    return person;
}

// Without regard to doublings.
Result<perception::Selection> select_for(const std::string& preset, const std::vector<std::string>& models, const std::vector<std::string>& settings,
                                         const std::string& observer) {
    if (observer.empty()) return perception::select(preset, models, settings);
    ENTOPTIC_TRY(said, read_observer(observer));
    const std::vector<PersonSetting> person = with_wearer(std::move(said));
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
