#include "perception/curves/curve.h"

#include "gpu/commands.h"
#include "perception/curves/curve_table.h"
#include "perception/preset.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace entoptic::perception {
namespace {

std::vector<Curve> make_table() {
    std::vector<Curve> all;
    for (auto* make : {&pupil_curves, &adaptation_curves, &tone_curves, &glare_curves, &acuity_curves, &mesopic_curves, &afterimage_curves, &dof_curves,
                       &foveation_curves})
        for (Curve& curve : make()) all.push_back(std::move(curve));
    return all;
}

std::string_view combined_model(std::string_view slot) {
    for (const Preset& preset : presets())
        if (preset.name == "combined")
            for (const auto& [name, model] : preset.models)
                if (name == slot) return model;
    return {};
}

template <class Names> bool contains(const Names& names, std::string_view name) {
    return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

const CurveSetting* setting_of(const Curve& curve, std::string_view name, std::size_t& at) {
    const auto& all = curve.kind->settings;
    for (at = 0; at < all.size(); ++at)
        if (name == all[at].name) return contains(curve.without, name) ? nullptr : &all[at];
    return nullptr;
}

// Whether the curve takes a setting of this name.
bool takes(const Curve& curve, std::string_view name) {
    std::size_t at = 0;
    if (setting_of(curve, name, at)) return true;
    return std::any_of(curve.parameters.begin(), curve.parameters.end(),
                       [&](const CurveAlias& p) { return name == p.name || contains(p.parameters, name); });
}

Result<gpu::Buffer> upload(const gpu::Device& device, const std::vector<float>& values, const char* name) {
    const std::size_t bytes = std::max<std::size_t>(values.size(), 16) * sizeof(float);
    ENTOPTIC_TRY(buffer, gpu::Buffer::create(device, bytes, gpu::BufferKind::upload, name));
    std::copy(values.begin(), values.end(), buffer.as<float>().begin());
    return buffer;
}

std::string range_of(double min, double max, std::string_view unit) {
    return unit == "1" || unit == "bool" ? fmt::format("{:g}..{:g}", min, max) : fmt::format("{:g}..{:g} {}", min, max, unit);
}

}  // namespace

std::span<const Curve> curves() {
    static const std::vector<Curve> table = make_table();
    return table;
}

Result<const Curve*> find_curve(std::string_view name, std::string_view model) {
    std::vector<std::string_view> names, with;
    const Curve *first = nullptr, *combined = nullptr, *wanted = nullptr;
    for (const Curve& curve : curves()) {
        if (!contains(names, curve.kind->name)) names.push_back(curve.kind->name);
        if (curve.kind->name != name) continue;
        with.push_back(curve.model);
        if (!first) first = &curve;
        if (curve.model == combined_model(curve.kind->slot)) combined = &curve;
        if (curve.model == model) wanted = &curve;
    }
    if (!first) return usage_error(fmt::format("There is no curve '{}'. Curves: {}.", name, fmt::join(names, ", ")));
    if (model.empty()) return combined ? combined : first;
    if (wanted) return wanted;
    const auto all = models();
    if (model == "none" || std::any_of(all.begin(), all.end(), [&](const ModelEntry* entry) { return entry->name == model; }))
        return failure(fmt::format("The model '{}' has no {}. Models that have it: {}.", model, name, fmt::join(with, ", ")));
    return usage_error(fmt::format("There is no model '{}' of {}. Models: {}.", model, name, fmt::join(with, ", ")));
}

CurveRequest::CurveRequest(const Curve& curve) : curve_(curve), entry_(find_model(curve.kind->slot, curve.model)) {
    for (const CurveSetting& setting : curve.kind->settings) input_.own.push_back(setting.default_value);
    if (entry_) input_.parameters = default_parameters(*entry_);
    for (const CurveAlias& alias : curve.parameters)
        if (std::size_t at = 0; alias.default_value && parameter(alias.parameters[0], at)) input_.parameters[at] = *alias.default_value;
}

const ParameterInfo* CurveRequest::parameter(std::string_view name, std::size_t& at) const {
    for (at = 0; entry_ && at < entry_->parameters.size(); ++at)
        if (name == entry_->parameters[at].name) return &entry_->parameters[at];
    return nullptr;
}

std::string CurveRequest::all_settings() const {
    std::vector<std::string> list;
    for (const CurveSetting& s : curve_.kind->settings)
        if (!contains(curve_.without, s.name)) list.push_back(fmt::format("{} ({})", s.name, range_of(s.min, s.max, s.unit)));
    for (const CurveAlias& alias : curve_.parameters) {
        std::size_t at = 0;
        const ParameterInfo* info = parameter(alias.parameters[0], at);
        const std::string range = info ? range_of(static_cast<double>(info->min), static_cast<double>(info->max), info->unit) : "";
        list.push_back(fmt::format("{} ({}{})", alias.name, alias.parameters.size() > 1 ? fmt::format("{} numbers, ", alias.parameters.size()) : "", range));
    }
    return fmt::format("Settings of {} by {}: model{}{}.", curve_.kind->name, curve_.model, list.empty() ? "" : ", ", fmt::join(list, ", "));
}

Result<void> CurveRequest::set_parameter(std::string_view alias, std::string_view name, double value) {
    std::size_t at = 0;
    const ParameterInfo* info = parameter(name, at);
    if (!info) return failure(fmt::format("The model {} has lost its parameter {}. Please report it.", curve_.model, name));
    const auto number = static_cast<float>(value);
    if (!(number >= info->min && number <= info->max))
        return usage_error(fmt::format("{}={:g} is out of range: {}.", alias, value,
                                       range_of(static_cast<double>(info->min), static_cast<double>(info->max), info->unit)));
    input_.parameters[at] = number;
    return {};
}

Result<bool> CurveRequest::set(std::string_view name, std::span<const double> values) {
    std::size_t at = 0;
    if (const CurveSetting* setting = setting_of(curve_, name, at)) {
        if (values.size() != 1) return usage_error(fmt::format("{} is one number.", name));
        if (!(values[0] >= setting->min && values[0] <= setting->max))
            return usage_error(fmt::format("{}={:g} is out of range: {}.", name, values[0], range_of(setting->min, setting->max, setting->unit)));
        input_.own[at] = values[0];
        return true;
    }
    for (const CurveAlias& alias : curve_.parameters) {
        const bool whole = name == alias.name;
        if (!whole && !contains(alias.parameters, name)) continue;
        if (values.size() != (whole ? alias.parameters.size() : 1))
            return usage_error(fmt::format("{} takes {} number{}, with commas between them.", name,
                                           whole ? alias.parameters.size() : 1, whole && alias.parameters.size() > 1 ? "s" : ""));
        for (std::size_t i = 0; i < values.size(); ++i) ENTOPTIC_CHECK(set_parameter(name, whole ? alias.parameters[i] : name, values[i]));
        return true;
    }
    if (contains(curve_.without, name)) return false;
    for (const Curve& other : curves())
        if (other.kind == curve_.kind && takes(other, name)) return false;
    return usage_error(fmt::format("There is no setting '{}'. {}", name, all_settings()));
}

std::vector<CurveRequest::Setting> CurveRequest::settings() const {
    std::vector<Setting> list;
    for (std::size_t i = 0; i < input_.own.size(); ++i) {
        const CurveSetting& s = curve_.kind->settings[i];
        if (contains(curve_.without, s.name)) continue;
        const bool left_out = s.optional && !(input_.own[i] >= s.min && input_.own[i] <= s.max);
        list.push_back({s.name, s.unit, left_out ? std::vector<double>{} : std::vector{input_.own[i]}});
    }
    for (const CurveAlias& alias : curve_.parameters) {
        Setting setting{alias.name, "", {}};
        for (const char* name : alias.parameters) {
            std::size_t at = 0;
            if (const ParameterInfo* info = parameter(name, at)) setting.unit = info->unit, setting.values.push_back(static_cast<double>(input_.parameters[at]));
        }
        list.push_back(std::move(setting));
    }
    return list;
}

std::vector<std::string> CurveRequest::columns() const {
    std::vector<std::string> names{"x"};
    for (const char* way : {"gpu", "double", "reference"})
        for (const char* part : curve_.kind->parts) names.push_back(fmt::format("{}{}", way, part));
    return names;
}

Result<std::vector<float>> CurveRequest::on_gpu(gpu::Device& device, const CurveInput& input, std::span<const double> xs) const {
    using enum gpu::BindingKind;
    std::vector<float> settings(input.own.begin(), input.own.end());
    if (settings.empty()) settings.push_back(0);    // NoSettings
    settings.insert(settings.end(), input.parameters.begin(), input.parameters.end());
    const std::size_t bytes = xs.size() * curve_.kind->parts.size() * sizeof(float);
    ENTOPTIC_TRY(kernel, gpu::Kernel::create(device, {std::string(curve_.kind->name), curve_.spirv,
                                                      {storage_buffer, storage_buffer, storage_buffer, storage_buffer}, sizeof(uint), {}}));
    ENTOPTIC_TRY(x, upload(device, std::vector<float>(xs.begin(), xs.end()), "curve.x"));
    ENTOPTIC_TRY(own, upload(device, settings, "curve.settings"));
    ENTOPTIC_TRY(table, upload(device, input.table, "curve.table"));
    ENTOPTIC_TRY(y, gpu::Buffer::create(device, bytes, gpu::BufferKind::readback, "curve.y"));
    ENTOPTIC_TRY(commands, gpu::Commands::create(device, "curve"));
    ENTOPTIC_CHECK(commands.begin());
    const auto count = static_cast<uint>(xs.size());
    commands.dispatch(kernel, {x, y, own, table}, count, {gpu::groups_for(count, 64), 1, 1});
    commands.barrier();
    ENTOPTIC_CHECK(commands.submit());
    ENTOPTIC_CHECK(commands.wait());
    const auto values = y.as<float>();
    return std::vector<float>(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(bytes / sizeof(float)));
}

Result<void> CurveRequest::check(std::span<const double> xs) const {
    const CurveKind& kind = *curve_.kind;
    if (xs.empty()) return usage_error("A curve needs at least one x.");
    for (const double x : xs)
        if (!(x >= kind.x_min && x <= kind.x_max))
            return usage_error(fmt::format("x = {:g} is out of range: {} ({}) from {:g} to {:g}.", x, kind.x_name, kind.x_unit, kind.x_min, kind.x_max));
    return {};
}

Result<std::vector<std::vector<double>>> CurveRequest::rows(gpu::Device& device, std::span<const double> xs) const {
    ENTOPTIC_CHECK(check(xs));
    CurveInput input = input_;
    if (curve_.table) input.table = curve_.table(input);
    ENTOPTIC_TRY(gpu, on_gpu(device, input, xs));
    const std::vector<double> exact = curve_.exact(input, xs), reference = curve_.reference(input, xs);
    const std::size_t parts = curve_.kind->parts.size();
    std::vector<std::vector<double>> rows;
    for (std::size_t i = 0; i < xs.size(); ++i) {
        std::vector<double> row{xs[i]};
        for (std::size_t k = 0; k < parts; ++k) row.push_back(static_cast<double>(gpu[parts * i + k]));
        for (const auto* values : {&exact, &reference})
            for (std::size_t k = 0; k < parts; ++k) row.push_back((*values)[parts * i + k]);
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace entoptic::perception
