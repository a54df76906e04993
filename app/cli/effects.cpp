// `entoptic effects`: every slot, its models, the presets, and each parameter.
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "perception/preset.h"

#include <fmt/format.h>
#include <memory>

namespace entoptic::app {
namespace {

using namespace perception;

Json parameter_json(const ParameterInfo& p) {
    return {{"name", p.name},
            {"unit", p.unit},
            {"min", decimal(p.min)},
            {"max", decimal(p.max)},
            {"default", decimal(p.default_value)},
            {"source", p.source},
            {"meaning", p.meaning}};
}

Json model_json(const ModelEntry& entry) {
    Json parameters = Json::array();
    for (const ParameterInfo& p : entry.parameters) parameters.push_back(parameter_json(p));
    Json files = Json::array();
    for (const FileInfo& f : entry.files) files.push_back({{"name", f.name}, {"meaning", f.meaning}});
    return {{"name", entry.name}, {"summary", entry.summary}, {"parameters", parameters}, {"files", files}};
}

std::string_view model_of(const Preset& preset, std::string_view slot) {
    for (const auto& [name, model] : preset.models)
        if (name == slot) return model;
    return "none";
}

const Preset& preset_named(std::string_view name) {
    for (const Preset& preset : presets())
        if (preset.name == name) return preset;
    return presets().front();
}

Json slot_json(std::string_view slot) {
    Json list = Json::array();
    list.push_back({{"name", "none"}, {"summary", "The slot is empty: nothing is simulated"}, {"parameters", Json::array()}});
    for (const ModelEntry* entry : models())
        if (entry->slot == slot) list.push_back(model_json(*entry));
    return {{"slot", slot}, {"default", model_of(preset_named(default_preset), slot)}, {"models", list}};
}

Json preset_json(const Preset& preset) {
    Json chosen = Json::object(), settings = Json::object();
    for (const auto slot : slots()) chosen[std::string(slot)] = model_of(preset, slot);
    for (const PresetParameter& p : preset.parameters) settings[fmt::format("{}.{}", p.slot, p.name)] = decimal(p.value);
    return {{"name", preset.name},
            {"summary", preset.summary},
            {"default", preset.name == default_preset},
            {"models", chosen},
            {"settings", settings}};
}

Json effects_json() {
    Json all_slots = Json::array(), all_presets = Json::array();
    for (const auto slot : slots()) all_slots.push_back(slot_json(slot));
    for (const Preset& preset : presets()) all_presets.push_back(preset_json(preset));
    const Json foveation = {{"inverse", {{"choices", {"off", "exact", "fitted"}}, {"default", "off"}}},
                            {"reduction", {{"min", least_foveation_reduction}, {"max", most_foveation_reduction}, {"default", FoveationSettings{}.reduction}}}};
    return {{"slots", all_slots}, {"presets", all_presets}, {"foveation", foveation}};
}

void print_parameter(std::string_view slot, const ParameterInfo& p) {
    const std::string name = fmt::format("{}.{}", slot, p.name);
    const std::string unit = std::string_view(p.unit) == "1" ? "" : fmt::format(" {}", p.unit);
    fmt::print("      {:<34} {:g}{}  [{:g} .. {:g}]\n          {}. Source: {}\n", name, p.default_value, unit, p.min, p.max, p.meaning,
               p.source);
}

void print_table() {
    for (const auto slot : slots()) {
        fmt::print("{}  (preset {}: {})\n", slot, default_preset, model_of(preset_named(default_preset), slot));
        for (const ModelEntry* entry : models()) {
            if (entry->slot != slot) continue;
            fmt::print("  {}: {}\n", entry->name, entry->summary);
            for (const ParameterInfo& p : entry->parameters) print_parameter(slot, p);
            for (const FileInfo& f : entry->files)
                fmt::print("      {:<34} none  [a path]\n          {}\n", fmt::format("{}.{}", slot, f.name), f.meaning);
        }
    }
    fmt::print("\nfoveation  (off in every preset): a smaller image about the gaze that the models work on\n"
               "      {:<34} off  [off, exact, fitted]\n          its map: off, Liu 2021 inverted exactly, or by the paper's fit\n"
               "      {:<34} {:g}  [{:g} .. {:g}]\n          linear, of the image's side\n",
               "foveation.inverse", "foveation.reduction", FoveationSettings{}.reduction, least_foveation_reduction, most_foveation_reduction);
    fmt::print("\nPresets\n");
    for (const Preset& preset : presets())
        fmt::print("  {:<24} {}{}\n", preset.name, preset.summary, preset.name == default_preset ? " (default)" : "");
    fmt::print("\nChange them with --preset NAME, --model SLOT=NAME (or SLOT=none) and --set SLOT.parameter=value.\n");
}

}  // namespace

void add_effects(CLI::App& app, Action& action) {
    auto json = std::make_shared<bool>(false);
    CLI::App* command = app.add_subcommand("effects", "List every effect, its parameters and the presets");
    command->add_flag("--json", *json, "One JSON document on standard output");
    command->callback([json, &action] {
        action = [json]() -> Result<int> {
            if (*json)
                print_json(effects_json());
            else
                print_table();
            return 0;
        };
    });
}

}  // namespace entoptic::app
