// CPU time of a frame of which nothing is simulated: warp, lens and panel in one pass or one after another, with preset off or `combined`, at 2 × 640×720 (1280×720 in all), through the Vive Pro's
// lens, from layers of 896×1007 an eye (Monado's view size at that output, facts/peers.md).
#include "compositor/testing/frame_harness.h"

#include <benchmark/benchmark.h>
#include <ctime>
#include <map>

namespace entoptic::compositor {
namespace {

using namespace testing;

double process_cpu_s() {
    timespec ts{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &ts);
    return double(ts.tv_sec) + double(ts.tv_nsec) * 1e-9;
}

Codes gradient(int x, int y) { return {std::uint8_t(x), std::uint8_t(y), std::uint8_t(x ^ y), 200}; }

void compose(benchmark::State& state, bool fuse, int quads, LensFilter filter = LensFilter::catmull_rom, const char* preset = "off") {
    auto& device = test_device();
    SwapchainPool pool(device);
    FramePathOptions options;
    options.panel = {640, 720};
    options.eyes = vive_pro_eyes();
    options.fuse = fuse;
    options.lens_filter = filter;
    options.selection = must(perception::select(preset));
    const auto path = must(FramePath::create(device, options));
    const Texture view = make_texture(device, pool, 896, 1007, gradient), picture = make_texture(device, pool, 512, 512, gradient);
    std::vector<Layer> layers{projection_layer(view, options.eyes)};
    for (int i = 0; i < quads; ++i) {
        layers.push_back(quad_layer(picture, {0.1f * float(i), 0, -1}, 0.6f, 0.6f));
        layers.back().blend_texture_source_alpha = true;
    }
    const ImageUse use = pool.use(layers);
    std::uint64_t index = 0;
    must(path->compose(description(layers, options.eyes, index++), use));  // compiles the shaders
    double least = 1e9;
    std::map<std::string, double> stages;
    for (auto _ : state) {
        const double before = process_cpu_s();
        const FrameOutcome outcome = must(path->compose(description(layers, options.eyes, index++), use));
        const double cpu = process_cpu_s() - before;
        least = std::min(least, cpu);
        state.SetIterationTime(cpu);
        for (const StageMs& stage : outcome.gpu_ms) stages[stage.name] += stage.ms;
    }
    for (const auto& [name, ms] : stages) state.counters[name + "_ms"] = ms / double(state.iterations());
    state.counters["least_cpu_ms"] = least * 1e3;
}

void measure(benchmark::internal::Benchmark* b) { b->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(15); }

BENCHMARK_CAPTURE(compose, fused_projection, true, 0)->Apply(measure);
BENCHMARK_CAPTURE(compose, fused_projection_quad, true, 1)->Apply(measure);
BENCHMARK_CAPTURE(compose, fused_projection_8_quads, true, 8)->Apply(measure);
BENCHMARK_CAPTURE(compose, stages_projection_catmull_rom, false, 0, LensFilter::catmull_rom)->Apply(measure);
BENCHMARK_CAPTURE(compose, combined_ordinary, true, 0, LensFilter::catmull_rom, "combined")->Apply(measure);
BENCHMARK_CAPTURE(compose, combined_stages_projection, false, 0, LensFilter::catmull_rom, "combined")->Apply(measure);
BENCHMARK_CAPTURE(compose, stages_projection_bilinear, false, 0, LensFilter::bilinear)->Apply(measure);

}  // namespace
}  // namespace entoptic::compositor
