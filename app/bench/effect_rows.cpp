#include "app/bench/effect_rows.h"

#include "app/bench/bench_scene.h"
#include "app/simulation/simulator.h"
#include "base/colour_difference.h"
#include "perception/preset.h"
#include "shaders/colour_math.glsl"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace entoptic::app {
namespace {

using namespace perception;

// Parameters that trade time for error. The first value is the finest: the truth is computed with it.
struct Trade {
    const char *slot, *parameter;
    std::vector<double> values;
};
const std::vector<Trade>& trades() {
    static const std::vector<Trade> table{
        {"glare", "wavelengths", {32, 8, 4, 3}}, {"glare", "texel_px", {1, 2, 4, 8}}, {"glare", "near_px", {8, 4, 0}},
        {"dof", "roulette", {0, 1}}};
    return table;
}

const ParameterInfo* parameter_of(const Choice& choice, std::string_view name) {
    for (const ParameterInfo& p : choice.entry->parameters)
        if (p.name == name) return &p;
    return nullptr;
}

struct Variant {
    const ModelEntry* entry;
    std::string setting;     // empty: default

    std::string slot() const { return std::string(entry->slot); }
    std::vector<std::string> models() const { return {fmt::format("{}={}", entry->slot, entry->name)}; }
    std::vector<std::string> settings() const {
        return setting.empty() ? std::vector<std::string>{} : std::vector{fmt::format("{}.{}", entry->slot, setting)};
    }
};

// The model with the parameters that the preset gives it, and each setting that trades time for error.
Result<std::vector<Variant>> variants_of(const ModelEntry& entry, const std::string& preset) {
    std::vector<Variant> list{{&entry, ""}};
    ENTOPTIC_TRY(selection, select(preset, list[0].models()));
    const Choice& choice = *selection.find(entry.slot);
    for (const Trade& trade : trades()) {
        const ParameterInfo* p = trade.slot == entry.slot ? parameter_of(choice, trade.parameter) : nullptr;
        if (!p) continue;
        const double chosen = static_cast<double>(choice.parameters[std::size_t(p - choice.entry->parameters.data())]);
        for (const double value : trade.values)
            if (p->allows(value) && value != chosen) list.push_back({&entry, fmt::format("{}={:g}", trade.parameter, value)});
    }
    return list;
}

FrameInput steady_input(std::uint64_t index) {
    FrameInput input;
    input.dt_s = 1.0 / 90;
    input.snap = index == 0;
    input.index = index;
    EyeInput eye;
    eye.pupil_diameter_mm = 5;
    input.eyes = {eye};
    return input;
}

class Bench {
public:
    Bench(gpu::Device& device, const EffectBenchOptions& options)
        : device_(device),
          o_(options),
          scene_(bench_scene(o_.error_width, o_.error_height)),
          timed_scene_(bench_scene(o_.width, o_.height)),
          depth_(bench_depth(o_.error_width, o_.error_height)),
          timed_depth_(bench_depth(o_.width, o_.height)) {}

    Result<std::vector<EffectRow>> run() {
        ENTOPTIC_TRY(preset, select(o_.preset));
        std::vector<Variant> all;
        for (const ModelEntry* entry : models()) {
            const Choice* choice = preset.find(entry->slot);
            const bool in_preset = choice && choice->entry == entry;
            if (!in_preset && !o_.all_models) continue;
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
    Result<EffectRow> measure(const Variant& variant, bool in_preset) {
        EffectRow row{variant.slot(),
                      std::string(variant.entry->name),
                      variant.setting.empty() ? "default" : variant.setting,
                      in_preset && variant.setting.empty(),
                      {},
                      {}};
        ENTOPTIC_TRY(time, time_of(variant));
        row.time_ms = time;
        ENTOPTIC_TRY(error, error_of(variant));
        row.error = error;
        return row;
    }

    Result<Percentiles> time_of(const Variant& variant) {
        ENTOPTIC_TRY(selection, select(o_.preset, variant.models(), variant.settings()));
        ENTOPTIC_TRY(stage, Stage::create(device_, {{bench_geometry(o_.width, o_.height)}, {}, selection, 1}));
        ENTOPTIC_TRY(commands, gpu::Commands::create(device_, "bench"));
        constexpr int warm_up = 2;  // pipelines are compiled at their first dispatch
        std::vector<double> times;
        for (int i = 0; i < o_.frames + warm_up; ++i) {
            ENTOPTIC_CHECK(commands.begin());
            ENTOPTIC_CHECK(stage->record_ingest(commands, {&timed_scene_, 1}, {&timed_depth_, 1}));
            stage->record(commands, steady_input(std::uint64_t(i)));
            ENTOPTIC_CHECK(commands.submit());
            ENTOPTIC_CHECK(commands.wait());
            double ms = 0;
            for (const gpu::StageTime& t : commands.stage_times())
                if (t.name == "perceive." + variant.slot()) ms += t.ms;
            if (i >= warm_up) times.push_back(ms);
        }
        return percentiles(std::move(times));
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
    Result<PictureError> error_of(const Variant& variant) {
        ENTOPTIC_TRY(selection, alone(variant, variant.settings()));
        ENTOPTIC_TRY(gpu, make_gpu_simulator(device_, options_for(selection)));
        ENTOPTIC_CHECK(gpu->frame(scene_, depth_, steady_input(0), true));
        ENTOPTIC_TRY(truth, truth_of(variant));
        return compare(gpu->picture(), *truth);
    }
    SimulatorOptions options_for(const Selection& selection) const {
        return {bench_geometry(o_.error_width, o_.error_height), {}, selection, 1};
    }

    Result<const ImageF*> truth_of(const Variant& variant) {
        const std::string name(variant.entry->name);
        if (const auto known = truths_.find(name); known != truths_.end()) return &known->second;
        std::vector<std::string> finest;
        for (const Trade& trade : trades())
            if (trade.slot == variant.entry->slot)
                for (const ParameterInfo& p : variant.entry->parameters)
                    if (trade.parameter == std::string_view(p.name)) finest.push_back(finest_setting(trade, p));
        ENTOPTIC_TRY(selection, alone(variant, finest));
        const auto reference = make_reference_simulator(options_for(selection));
        ENTOPTIC_CHECK(reference->frame(scene_, depth_, steady_input(0), true));
        return &(truths_[name] = reference->picture());
    }
    static std::string finest_setting(const Trade& trade, const ParameterInfo& p) {
        return fmt::format("{}.{}={}", trade.slot, trade.parameter,
                           std::clamp(trade.values[0], static_cast<double>(p.min), static_cast<double>(p.max)));
    }
    static PictureError compare(const ImageF& got, const ImageF& wanted);

    gpu::Device& device_;
    const EffectBenchOptions& o_;
    ImageF scene_, timed_scene_, depth_, timed_depth_;
    std::map<std::string, ImageF> truths_;  // by model
};

PictureError Bench::compare(const ImageF& got_raw, const ImageF& wanted_raw) {
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

}  // namespace

Percentiles percentiles(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) { return values[std::size_t(std::ceil(share * double(values.size()))) - 1]; };
    return {at(0.5), at(0.95)};
}

Result<std::vector<EffectRow>> effect_rows(gpu::Device& device, const EffectBenchOptions& options) { return Bench(device, options).run(); }

}  // namespace entoptic::app
