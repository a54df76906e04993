#include "perception/preset.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <optional>

namespace entoptic::perception {
namespace {

std::vector<std::string> model_names(std::string_view slot) {
    std::vector<std::string> names{"none"};
    for (const ModelEntry* entry : models())
        if (entry->slot == slot) names.emplace_back(entry->name);
    return names;
}

using ModelOfSlot = std::map<std::string, Choice, std::less<>>;

Result<void> expect_slot(std::string_view slot) {
    const auto all = slots();
    if (std::find(all.begin(), all.end(), slot) != all.end()) return {};
    return usage_error(fmt::format("There is no slot '{}'. Slots: {}.", slot, fmt::join(all, ", ")));
}

Result<void> choose(ModelOfSlot& chosen, std::string_view slot, std::string_view model) {
    ENTOPTIC_CHECK(expect_slot(slot));
    if (model == "none") {
        chosen.erase(std::string(slot));
        return {};
    }
    const ModelEntry* entry = find_model(slot, model);
    if (!entry) return usage_error(fmt::format("The slot '{}' has no model '{}'. Models: {}.", slot, model, fmt::join(model_names(slot), ", ")));
    chosen[std::string(slot)] = {entry, default_parameters(*entry), {}};
    return {};
}

Result<void> set_parameter(ModelOfSlot& chosen, std::string_view slot, std::string_view name, double value) {
    ENTOPTIC_CHECK(expect_slot(slot));
    const auto found = chosen.find(slot);
    if (found == chosen.end())
        return usage_error(fmt::format("Nothing to set: the slot '{}' has no model in this choice. Add --model {}=NAME.", slot, slot));
    Choice& choice = found->second;
    std::vector<std::string_view> names;
    for (std::size_t i = 0; i < choice.entry->parameters.size(); ++i) {
        const ParameterInfo& info = choice.entry->parameters[i];
        names.emplace_back(info.name);
        if (name != info.name) continue;
        if (!info.allows(value)) return usage_error(fmt::format("{}.{} = {} is out of range: {}.", slot, name, value, range_text(info)));
        choice.parameters[i] = static_cast<float>(value);
        return {};
    }
    for (const FileInfo& file : choice.entry->files) names.emplace_back(file.name);
    return usage_error(fmt::format("The model '{}' has no parameter '{}'. Parameters: {}.", choice.entry->name, name, fmt::join(names, ", ")));
}

// A usage error that names the models which have such a file.
tl::unexpected<Error> no_file(std::string_view slot, std::string_view name) {
    std::vector<std::string> with;
    for (const ModelEntry* entry : models())
        for (const FileInfo& file : entry->files)
            if (entry->slot == slot && file.name == name) with.push_back(fmt::format("{}={}", slot, entry->name));
    return usage_error(
        fmt::format("{}.{} is a file that only {} reads. Add --model {}.", slot, name, fmt::join(with, " and "), with.front()));
}

// False when no model of the slot has a file of this name.
Result<bool> set_file(ModelOfSlot& chosen, std::string_view slot, std::string_view name, const std::string& path) {
    if (!names_file(slot, name)) return false;
    const auto found = chosen.find(slot);
    if (found == chosen.end()) return no_file(slot, name);
    for (const FileInfo& info : found->second.entry->files) {
        if (name != info.name) continue;
        if (path.empty()) {
            found->second.files.erase(info.name);
            return true;
        }
        if (const auto good = info.check(path); !good) return usage_error(fmt::format("{}.{}: {}", slot, name, good.error().message));
        found->second.files[info.name] = path;
        return true;
    }
    return no_file(slot, name);
}

Result<void> set_foveation(FoveationSettings& foveation, std::string_view name, std::string_view value) {
    if (name == "inverse") {
        for (const FoveationInverse inverse : {FoveationInverse::off, FoveationInverse::exact, FoveationInverse::fitted})
            if (value == name_of(inverse)) {
                foveation.inverse = inverse;
                return {};
            }
        return usage_error(fmt::format("--set foveation.inverse={}: off, exact or fitted.", value));
    }
    if (name != "reduction") return usage_error(fmt::format("Foveation has no parameter '{}'. Parameters: inverse, reduction.", name));
    float reduction = 0;
    const auto parsed = std::from_chars(value.data(), value.data() + value.size(), reduction);
    if (parsed.ec != std::errc() || parsed.ptr != value.data() + value.size() || !(reduction >= least_foveation_reduction && reduction <= most_foveation_reduction))
        return usage_error(fmt::format("--set foveation.reduction={}: a number from {} to {}.", value, least_foveation_reduction, most_foveation_reduction));
    foveation.reduction = reduction;
    return {};
}

// Two parameters of which the first cannot be above the second.
struct Ordered {
    std::string_view slot, low, high;
};
constexpr Ordered ordered[] = {{"pupil", "least_mm", "most_mm"}, {"pupil", "white_mm", "black_mm"}, {"scotoma", "inner_deg", "outer_deg"}};

std::optional<float> value_of(const Choice& choice, std::string_view name) {
    for (std::size_t i = 0; i < choice.entry->parameters.size(); ++i)
        if (name == choice.entry->parameters[i].name) return choice.parameters[i];
    return std::nullopt;
}

Result<void> expect_order(const Selection& selection) {
    for (const Ordered& pair : ordered) {
        const Choice* choice = selection.find(pair.slot);
        const auto low = choice ? value_of(*choice, pair.low) : std::nullopt, high = choice ? value_of(*choice, pair.high) : std::nullopt;
        if (low && high && *low > *high)
            return usage_error(fmt::format("{0}.{1} = {2} must not be above {0}.{3} = {4}.", pair.slot, pair.low, *low, pair.high, *high));
    }
    return {};
}

}  // namespace

std::string range_text(const ParameterInfo& p) {
    const std::string_view unit = p.unit;
    return fmt::format("{:g} to {:g}{}", p.min, p.max, unit == "1" || unit == "bool" ? "" : fmt::format(" {}", unit));
}

const Choice* Selection::find(std::string_view slot) const {
    const auto found = std::find_if(choices.begin(), choices.end(), [&](const Choice& c) { return c.entry->slot == slot; });
    return found == choices.end() ? nullptr : &*found;
}

Result<Selection> select(std::string_view preset, const std::vector<std::string>& wanted_models, const std::vector<std::string>& settings) {
    const auto all = presets();
    const auto base = std::find_if(all.begin(), all.end(), [&](const Preset& p) { return p.name == preset; });
    if (base == all.end()) {
        std::vector<std::string_view> names;
        for (const Preset& p : all) names.push_back(p.name);
        return usage_error(fmt::format("There is no preset '{}'. Presets: {}.", preset, fmt::join(names, ", ")));
    }
    ModelOfSlot chosen;
    for (const auto& [slot, model] : base->models) ENTOPTIC_CHECK(choose(chosen, slot, model));
    for (const PresetParameter& p : base->parameters) ENTOPTIC_CHECK(set_parameter(chosen, p.slot, p.name, static_cast<double>(p.value)));
    for (const std::string& text : wanted_models) {
        const auto equals = text.find('=');
        if (equals == std::string::npos) return usage_error(fmt::format("--model {}: write SLOT=NAME.", text));
        ENTOPTIC_CHECK(choose(chosen, std::string_view(text).substr(0, equals), std::string_view(text).substr(equals + 1)));
    }
    FoveationSettings foveation;
    for (const std::string& text : settings) {
        const auto equals = text.find('='), dot = text.find('.');
        if (equals == std::string::npos || dot == std::string::npos || dot > equals)
            return usage_error(fmt::format("--set {}: write SLOT.PARAMETER=VALUE.", text));
        const std::string_view slot = std::string_view(text).substr(0, dot), name = std::string_view(text).substr(dot + 1, equals - dot - 1);
        if (slot == "foveation") {
            ENTOPTIC_CHECK(set_foveation(foveation, name, std::string_view(text).substr(equals + 1)));
            continue;
        }
        ENTOPTIC_TRY(is_file, set_file(chosen, slot, name, text.substr(equals + 1)));
        if (is_file) continue;
        double value = 0;
        const char* end = text.data() + text.size();
        const auto parsed = std::from_chars(text.data() + equals + 1, end, value);
        if (parsed.ec != std::errc() || parsed.ptr != end || !std::isfinite(value))
            return usage_error(fmt::format("--set {}: '{}' is not a number.", text, text.substr(equals + 1)));
        ENTOPTIC_CHECK(set_parameter(chosen, slot, name, value));
    }
    Selection selection{std::string(preset), {}, foveation};
    for (const ModelEntry* entry : models())
        if (const auto found = chosen.find(entry->slot); found != chosen.end() && found->second.entry == entry) selection.choices.push_back(found->second);
    ENTOPTIC_CHECK(expect_order(selection));
    return selection;
}

}  // namespace entoptic::perception
