#include "app/bench/storage_rows.h"

#include "app/bench/bench_scene.h"
#include "app/simulation/simulator.h"
#include "perception/preset.h"
#include "perception/storage/storage_pass.h"

namespace entoptic::app {
namespace {

using namespace perception;

struct Variant {
    const char* setting;
    StorageFormat format;
    bool exposed;
};
constexpr Variant variants[] = {
    {"fp32", StorageFormat::fp32, false},
    {"fp16", StorageFormat::fp16, false},
    {"fp16 pre-exposed", StorageFormat::fp16, true},
    {"R11G11B10", StorageFormat::r11g11b10, false},
    {"RGB9E5", StorageFormat::rgb9e5, false},
};

Result<ImageF> seen(gpu::Device& device, const EffectBenchOptions& o, const ImageF& scene) {
    ENTOPTIC_TRY(selection, select(o.preset));
    ENTOPTIC_TRY(simulator, make_gpu_simulator(device, {headset_patch(scene.width, scene.height), {}, selection, 1}));
    FrameInput input;
    input.snap = true;
    input.eyes.resize(1);
    ENTOPTIC_CHECK(simulator->frame(scene, bench_depth(scene.width, scene.height), input, true));
    return simulator->picture();
}

Result<ImageF> kept(gpu::Device& device, const ImageF& scene, const Variant& variant) {
    ENTOPTIC_TRY(stored, through_storage(device, scene, variant.format, variant.exposed ? pre_exposure(scene) : 1, 1));
    return std::move(stored.picture);
}

}  // namespace

Result<std::vector<EffectRow>> storage_rows(gpu::Device& device, const EffectBenchOptions& o) {
    const ImageF scene = bench_scene(o.error_width, o.error_height), timed = bench_scene(o.width, o.height);
    ENTOPTIC_TRY(exact, seen(device, o, scene));
    std::vector<EffectRow> rows;
    for (const Variant& variant : variants) {
        ENTOPTIC_TRY(stored, through_storage(device, timed, variant.format, 1, o.frames));
        ENTOPTIC_TRY(rounded, kept(device, scene, variant));
        ENTOPTIC_TRY(picture, seen(device, o, rounded));
        EffectRow row;
        row.effect = "storage";
        row.model = "scene_buffer";
        row.setting = variant.setting;
        row.is_chosen = row.is_default = variant.format == StorageFormat::fp32;
        row.time_ms = percentiles(stored.pass_ms);
        row.error = picture_error(picture, exact);
        rows.push_back(std::move(row));
        if (o.progress) o.progress(rows.size(), std::size(variants));
    }
    mark_fastest(rows);
    return rows;
}

}  // namespace entoptic::app
