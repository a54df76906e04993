// Presets: a validated choice of one model a slot, with parameters. Anything can be overridden by name.
#pragma once

#include "base/result.h"
#include "perception/foveation/foveation_settings.h"
#include "perception/model.h"

#include <string>
#include <vector>

namespace entoptic::perception {

// What fills one slot.
struct Choice {
    const ModelEntry* entry = nullptr;
    std::vector<float> parameters;     // in the order of entry->parameters
    FilePaths files = {};              // of entry->files
};

// A complete choice: models in pipeline order; slots that are `none` do not appear.
struct Selection {
    std::string preset;
    std::vector<Choice> choices;
    FoveationSettings foveation = {};   // off in every preset
    const Choice* find(std::string_view slot) const;
};

struct PresetParameter {
    std::string_view slot, name;
    float value;
};
struct Preset {
    std::string_view name, summary;
    std::vector<std::pair<std::string_view, std::string_view>> models;   // slot, model
    std::vector<PresetParameter> parameters;                             // that differ from the models' defaults
};
std::span<const Preset> presets();
inline constexpr std::string_view default_preset = "combined";

// "10 to 90 years"; switches and pure numbers have no unit.
std::string range_text(const ParameterInfo& parameter);

// `models` holds "slot=model" (model may be "none"), `settings` "slot.parameter=value" or "slot.file=path"; later ones win.
// "foveation.inverse=off|exact|fitted" and "foveation.reduction=1..4" say how large an image the models work on.
// Errors (usage) name the choices there are: unknown preset, slot, model, parameter; value not a number or out of range; a file that the
// model cannot read.
Result<Selection> select(std::string_view preset, const std::vector<std::string>& models = {}, const std::vector<std::string>& settings = {});

}  // namespace entoptic::perception
