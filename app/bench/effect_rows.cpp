#include "app/bench/effect_rows.h"

#include "app/bench/bench_scene.h"
#include "app/bench/timed_frames.h"
#include "app/bench/trades.h"
#include "app/simulation/simulator.h"
#include "base/colour_difference.h"
#include "perception/preset.h"
#include "shaders/colour_math.glsl"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numeric>
#include <set>

namespace entoptic::app {
namespace {

using namespace perception;

constexpr float pupil_mm = 5;  // kernels are built there: rows that do not move it see none between two
constexpr float between_kernels_mm = 4.87f;
constexpr float pupil_step_mm = 0.02f;  // a frame: 1.8 mm/s at 90 Hz, a pupil that dilates
constexpr double history_s = 0.1;
constexpr double same_time = 1.05;

struct Variant {
    const ModelEntry* entry;
    const Trade* trade = nullptr;  // null: the model as the preset has it
    double value = 0;              // of the trade's parameter

    bool apart() const { return trade && (trade->changes_model || trade->needs_moving_pupil); }
    std::string slot() const { return std::string(entry->slot); }
    std::vector<std::string> models() const { return {fmt::format("{}={}", entry->slot, entry->name)}; }
    std::string setting() const { return trade ? fmt::format("{}={:g}", trade->parameter, value) : "default"; }
    std::vector<std::string> settings() const {
        return trade ? std::vector{fmt::format("{}.{}", entry->slot, setting())} : std::vector<std::string>{};
    }
};

std::optional<std::size_t> index_of(const ModelEntry& entry, std::string_view parameter) {
    for (std::size_t i = 0; i < entry.parameters.size(); ++i)
        if (entry.parameters[i].name == parameter) return i;
    return {};
}

// Those that the model has a parameter for; of two for the same parameter the first.
std::vector<const Trade*> trades_of(const ModelEntry& entry) {
    std::vector<const Trade*> list;
    std::set<std::string_view> known;
    for (const Trade& trade : trades())
        if (trade.slot == entry.slot && (trade.model.empty() || trade.model == entry.name) && index_of(entry, trade.parameter) &&
            known.insert(trade.parameter).second)
            list.push_back(&trade);
    return list;
}

float chosen_value(const Choice& choice, std::string_view parameter) { return choice.parameters[*index_of(*choice.entry, parameter)]; }

// The model with the parameters that the preset gives it, and each setting that trades time for error.
Result<std::vector<Variant>> variants_of(const ModelEntry& entry, const std::string& preset) {
    std::vector<Variant> list{{&entry}};
    ENTOPTIC_TRY(selection, select(preset, list[0].models()));
    const Choice& choice = *selection.find(entry.slot);
    for (const Trade* trade : trades_of(entry)) {
        const ParameterInfo& p = entry.parameters[*index_of(entry, trade->parameter)];
        const bool apart = trade->changes_model || trade->needs_moving_pupil;
        for (const double value : trade->values)
            if (p.allows(value) && (apart || static_cast<float>(value) != chosen_value(choice, trade->parameter)))
                list.push_back({&entry, trade, value});
    }
    return list;
}

// A model whose states come from earlier light is shown some.
bool remembers(std::string_view slot) { return slot == "adaptation" || slot == "afterimage"; }

FrameInput input_of(const Variant& variant, std::uint64_t index, bool moving) {
    FrameInput input;
    input.dt_s = history_s;
    input.snap = index == 0;
    input.index = index;
    EyeInput eye;
    eye.pupil_diameter_mm = pupil_mm;
    if (variant.trade && variant.trade->needs_moving_pupil)
        eye.pupil_diameter_mm = between_kernels_mm + (moving ? pupil_step_mm * static_cast<float>(index) : 0);
    input.eyes = {eye};
    return input;
}

// Of all the frame's stages those of the slot: "perceive.afterimage" and "perceive.afterimage.observe".
double slot_ms(const gpu::Commands& commands, const std::string& slot) {
    const std::string own = "perceive." + slot, parts = own + ".";
    double ms = 0;
    for (const gpu::StageTime& t : commands.stage_times())
        if (t.name == own || t.name.starts_with(parts)) ms += t.ms;
    return ms;
}

// What errors are measured on.
struct Compared {
    Compared(int width, int height)
        : geometry(headset_patch(width, height)),
          scene(bench_scene(width, height)),
          before(bench_scene_before(width, height)),
          depth(bench_depth(width, height)) {}
    EyeGeometry geometry;
    ImageF scene, before, depth;
};

class Bench {
public:
    Bench(gpu::Device& device, const EffectBenchOptions& options)
        : device_(device),
          o_(options),
          compared_(o_.error_width, o_.error_height),
          timed_scene_(bench_scene(o_.width, o_.height)),
          timed_depth_(bench_depth(o_.width, o_.height)) {}

    Result<std::vector<EffectRow>> run() {
        ENTOPTIC_TRY(preset, select(o_.preset));
        std::vector<Variant> all;
        for (const ModelEntry* entry : models()) {
            const Choice* choice = preset.find(entry->slot);
            const bool in_preset = choice && choice->entry == entry;
            if (!is_wanted(*entry, in_preset)) continue;
            ENTOPTIC_TRY(variants, variants_of(*entry, o_.preset));
            all.insert(all.end(), variants.begin(), variants.end());
        }
        std::vector<EffectRow> rows;
        for (const Variant& variant : all) {
            const Choice* choice = preset.find(variant.entry->slot);
            ENTOPTIC_TRY(row, measure(variant, choice && choice->entry == variant.entry));
            rows.push_back(std::move(row));
            if (o_.progress) o_.progress(rows.size(), all.size());
        }
        return rows;
    }

private:
    bool is_wanted(const ModelEntry& entry, bool in_preset) const {
        if (!o_.slot.empty()) return entry.slot == o_.slot && (o_.model.empty() || entry.name == o_.model);
        return in_preset || o_.all_models;
    }
    Result<EffectRow> measure(const Variant& variant, bool in_preset) {
        EffectRow row;
        row.effect = variant.slot();
        row.model = std::string(variant.entry->name);
        row.setting = variant.setting();
        row.parameter = variant.trade ? std::string(variant.trade->parameter) : "";
        row.apart = variant.apart();
        ENTOPTIC_TRY(selection, alone(variant, {}));
        const Choice& usual = *selection.find(variant.entry->slot);
        row.is_chosen = !variant.trade || chosen_value(usual, variant.trade->parameter) == static_cast<float>(variant.value);
        row.is_default = in_preset && row.is_chosen;
        ENTOPTIC_TRY(time, time_of(variant));
        row.time_ms = time;
        ENTOPTIC_TRY(error, error_of(variant));
        row.error = error;
        return row;
    }

    Result<Percentiles> time_of(const Variant& variant) {
        ENTOPTIC_TRY(selection, alone(variant, variant.settings()));
        ENTOPTIC_TRY(stage, Stage::create(device_, {{bench_geometry(o_.width, o_.height)}, {}, selection, 1}));
        ENTOPTIC_TRY(commands, gpu::Commands::create(device_, "bench"));
        return timed_frames(o_.frames, o_.seconds, [&](std::uint64_t index) -> Result<double> {
            ENTOPTIC_CHECK(commands.begin());
            ENTOPTIC_CHECK(stage->record_ingest(commands, {&timed_scene_, 1}, {&timed_depth_, 1}));
            stage->record(commands, input_of(variant, index, true));
            ENTOPTIC_CHECK(commands.submit());
            ENTOPTIC_CHECK(commands.wait());
            return slot_ms(commands, variant.slot());
        });
    }

    // The model with adaptation and tone, without which nothing of it could be displayed.
    Result<Selection> alone(const Variant& variant, const std::vector<std::string>& settings) const {
        ENTOPTIC_TRY(whole, select(o_.preset));
        std::vector<std::string> models = variant.models();
        for (const Choice& choice : whole.choices)
            if (choice.entry->slot != "adaptation" && choice.entry->slot != "tone" && choice.entry->slot != variant.entry->slot)
                models.push_back(fmt::format("{}=none", choice.entry->slot));
        return select(o_.preset, models, settings);
    }

    Result<void> show(Simulator& simulator, const Variant& variant) const {
        std::uint64_t index = 0;
        const Compared& c = compared_;
        if (remembers(variant.entry->slot)) ENTOPTIC_CHECK(simulator.frame(c.before, c.depth, input_of(variant, index++, false), false));
        return simulator.frame(c.scene, c.depth, input_of(variant, index, false), true);
    }
    Result<PictureError> error_of(const Variant& variant) {
        ENTOPTIC_TRY(selection, alone(variant, variant.settings()));
        ENTOPTIC_TRY(gpu, make_gpu_simulator(device_, options_for(selection)));
        ENTOPTIC_CHECK(show(*gpu, variant));
        ENTOPTIC_TRY(truth, truth_of(variant));
        return picture_error(gpu->picture(), *truth);
    }
    SimulatorOptions options_for(const Selection& selection) const { return {compared_.geometry, {}, selection, 1}; }

    // By the references, with the finest value of every parameter that only costs time, and of this trade's.
    Result<const ImageF*> truth_of(const Variant& variant) {
        std::vector<std::string> finest;
        for (const Trade* trade : trades_of(*variant.entry)) {
            if (trade->changes_model && trade != variant.trade) continue;
            const ParameterInfo& p = variant.entry->parameters[*index_of(*variant.entry, trade->parameter)];
            const double value = std::clamp(trade->values[0], static_cast<double>(p.min), static_cast<double>(p.max));
            finest.push_back(fmt::format("{}.{}={}", trade->slot, trade->parameter, value));
        }
        const std::string key =
            fmt::format("{} {} {}", variant.entry->name, variant.apart() ? variant.trade->parameter : "", fmt::join(finest, " "));
        if (const auto known = truths_.find(key); known != truths_.end()) return &known->second;
        ENTOPTIC_TRY(selection, alone(variant, finest));
        const auto reference = make_reference_simulator(options_for(selection));
        ENTOPTIC_CHECK(show(*reference, variant));
        return &(truths_[key] = reference->picture());
    }

    gpu::Device& device_;
    const EffectBenchOptions& o_;
    Compared compared_;
    ImageF timed_scene_, timed_depth_;
    std::map<std::string, ImageF> truths_;
};

// Of those `within` only.
template <class Within> void mark_fastest(std::vector<EffectRow>& rows, Within within) {
    EffectRow* best = nullptr;
    for (EffectRow& row : rows)
        if (within(row) && row.error.is_unseen() && (!best || row.typical_ms() < best->typical_ms())) best = &row;
    if (!best) return;
    for (EffectRow& row : rows)
        if (within(row) && row.is_chosen && row.error.is_unseen() && row.typical_ms() < same_time * best->typical_ms()) best = &row;
    best->is_fastest_unseen = true;
}

}  // namespace

void mark_fastest(std::vector<EffectRow>& rows) {
    std::set<std::pair<std::string, std::string>> groups;  // model, parameter of rows apart
    for (const EffectRow& row : rows) groups.insert({row.model, row.apart ? row.parameter : ""});
    for (const auto& [model, parameter] : groups)
        mark_fastest(rows, [&](const EffectRow& row) { return row.model == model && (row.apart ? row.parameter : "") == parameter; });
}

PictureError picture_error(const ImageF& got_raw, const ImageF& wanted_raw) {
    const DisplayRange display;
    const double black = static_cast<double>(display.black_cd_m2), white = static_cast<double>(display.white_cd_m2);
    const ImageD got = convert<double>(limited_to_display(got_raw, display)),
                 wanted = convert<double>(limited_to_display(wanted_raw, display));
    const auto code = [&](double cd) { return 255 * colour::srgb_encode((cd - black) / (white - black)); };
    PictureError error;
    std::vector<double> de;
    double got_light = 0, wanted_light = 0;
    for (std::size_t i = 0; i < got.data.size(); i += 3) {
        const std::array a{got.data[i], got.data[i + 1], got.data[i + 2]}, b{wanted.data[i], wanted.data[i + 1], wanted.data[i + 2]};
        de.push_back(delta_e_itp(a, b));
        for (std::size_t c = 0; c < 3; ++c) error.max_code = std::max(error.max_code, std::abs(code(a[c]) - code(b[c])));
        got_light += colour::luminance({a[0], a[1], a[2]});
        wanted_light += colour::luminance({b[0], b[1], b[2]});
        error.de_itp_mean += de.back();
    }
    error.de_itp_mean /= double(de.size());
    std::sort(de.begin(), de.end());
    error.de_itp_p99 = de[std::size_t(0.99 * double(de.size() - 1))];
    error.energy = std::abs(got_light - wanted_light) / wanted_light;
    return error;
}

Percentiles percentiles(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) { return values[std::size_t(std::ceil(share * double(values.size()))) - 1]; };
    return {at(0.5), at(0.95), std::accumulate(values.begin(), values.end(), 0.0) / double(values.size()), values.front()};
}

Result<std::vector<EffectRow>> effect_rows(gpu::Device& device, const EffectBenchOptions& options) {
    ENTOPTIC_TRY(rows, Bench(device, options).run());
    mark_fastest(rows);
    return rows;
}

}  // namespace entoptic::app
