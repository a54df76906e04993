#include "app/bench/foveation_rows.h"

#include "app/bench/bench_scene.h"
#include "app/bench/timed_frames.h"
#include "perception/preset.h"
#include "perception/stage.h"

namespace entoptic::app {
namespace {

using namespace perception;

struct Variant {
    const char *setting, *parameter;
    std::vector<std::string> settings;
};
const std::vector<Variant>& variants() {
    const auto exact = [](const char* reduction) {
        return std::vector<std::string>{"foveation.inverse=exact", std::string("foveation.reduction=") + reduction};
    };
    static const std::vector<Variant> list{
        {"full image", "", {}},
        {"exact, reduction=1", "exact, reduction", exact("1")},
        {"exact, reduction=2", "exact, reduction", exact("2")},
        {"exact, reduction=3", "exact, reduction", exact("3")},
        {"exact, reduction=4", "exact, reduction", exact("4")},
        {"fitted, reduction=2", "fitted, reduction", {"foveation.inverse=fitted", "foveation.reduction=2"}},
    };
    return list;
}

struct Run {
    Percentiles time_ms;
    ImageF picture;
};

Result<Run> run_of(gpu::Device& device, const EffectBenchOptions& o, const Variant& variant) {
    ENTOPTIC_TRY(selection, select(o.preset, {}, variant.settings));
    ENTOPTIC_TRY(stage, Stage::create(device, {{bench_geometry(o.width, o.height)}, {}, selection, 1}));
    ENTOPTIC_TRY(commands, gpu::Commands::create(device, "bench"));
    const ImageF scene = bench_scene(o.width, o.height), depth = bench_depth(o.width, o.height);
    ENTOPTIC_TRY(times, timed_frames(o.frames, o.seconds, [&](std::uint64_t index) -> Result<double> {
                     FrameInput input;
                     input.dt_s = 1.0 / 90;
                     input.snap = index == 0;
                     input.index = index;
                     input.eyes.resize(1);
                     ENTOPTIC_CHECK(commands.begin());
                     ENTOPTIC_CHECK(stage->record_ingest(commands, {&scene, 1}, {&depth, 1}));
                     stage->record(commands, input);
                     ENTOPTIC_CHECK(stage->record_download(commands, 0));
                     ENTOPTIC_CHECK(commands.submit());
                     ENTOPTIC_CHECK(commands.wait());
                     double ms = 0;
                     for (const gpu::StageTime& t : commands.stage_times())
                         if (t.name.starts_with("perceive.")) ms += t.ms;
                     return ms;
                 }));
    return Run{times, stage->downloaded(0)};
}

}  // namespace

Result<std::vector<EffectRow>> foveation_rows(gpu::Device& device, const EffectBenchOptions& options) {
    std::vector<EffectRow> rows;
    ImageF full;
    for (const Variant& variant : variants()) {
        ENTOPTIC_TRY(run, run_of(device, options, variant));
        if (full.data.empty()) full = run.picture;
        EffectRow row;
        row.effect = "foveation";
        row.model = "visual_polar";
        row.setting = variant.setting;
        row.parameter = variant.parameter;
        row.is_chosen = row.is_default = variant.settings.empty();
        row.time_ms = run.time_ms;
        row.error = picture_error(run.picture, full);
        rows.push_back(std::move(row));
        if (options.progress) options.progress(rows.size(), variants().size());
    }
    mark_fastest(rows);
    return rows;
}

}  // namespace entoptic::app
