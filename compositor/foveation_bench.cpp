// What foveation saves in the frame: CPU time of whole frames, all passes, of a night scene with lamps in a float layer, through the Vive Pro's lens
// with preset `combined`. Both ways in one run, frame about, so that a busy machine slows both. least_*: fastest frame of each.
#include "compositor/testing/frame_harness.h"

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <ctime>
#include <map>

namespace entoptic::compositor {
namespace {

using namespace testing;

double process_cpu_ms() {
    timespec ts{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &ts);
    return double(ts.tv_sec) * 1e3 + double(ts.tv_nsec) * 1e-6;
}

// Dark walls with texture, windows, five lamps of 6×6 texels and 3e4 cd/m².
std::array<float, 4> night(int x, int y, int width, int height) {
    const int lamp_x = x * 5 / width, at_x = lamp_x * width / 5 + width / 10, at_y = height / 3 + lamp_x * height / 20;
    float light = 0.02f * std::pow(10.0f, 0.5f * std::sin(float(x) * 0.05f) * std::sin(float(y) * 0.031f));
    if (x / (width / 12) % 3 == 1 && y / (height / 12) % 4 == 2) light = 4;
    if (std::abs(x - at_x) < 3 && std::abs(y - at_y) < 3) light = 3e4f;
    return {light, 0.9f * light, 0.7f * light, 1};
}

struct Frames {
    std::unique_ptr<FramePath> path;
    double least_ms = 1e30;
    std::map<std::string, double> stages = {};
};

void foveated_frame(benchmark::State& state, PictureSize panel, perception::FoveationInverse inverse, float reduction, const char* preset) {
    auto& device = test_device();
    SwapchainPool pool(device);
    const auto path_with = [&](perception::FoveationInverse of) {
        FramePathOptions options;
        options.panel = panel;
        options.eyes = vive_pro_eyes();
        options.selection = must(perception::select(preset));
        options.selection.foveation = {of, reduction};
        return Frames{must(FramePath::create(device, options))};
    };
    std::array<Frames, 2> ways{path_with(perception::FoveationInverse::off), path_with(inverse)};
    const int width = int(panel.width) * 7 / 5, height = int(panel.height) * 7 / 5;
    const Texture view = make_float_texture(device, pool, width, height, [&](int x, int y) { return night(x, y, width, height); });
    std::vector<Layer> layers{projection_layer(view, vive_pro_eyes())};
    layers[0].luminance = {1, 0, LuminanceSource::default_sdr};
    const ImageUse use = pool.use(layers);
    std::uint64_t index = 0;
    const auto frame = [&](Frames& way) {
        FrameDescription d = description(layers, vive_pro_eyes(), index++);
        for (auto& eye : d.perception.eyes) eye.gaze_direction = glm::normalize(vec3(0.1f * std::sin(0.1f * float(index)), 0.05f, -1));
        const double before = process_cpu_ms();
        const FrameOutcome outcome = must(way.path->compose(d, use));
        const double ms = process_cpu_ms() - before;
        for (const StageMs& stage : outcome.gpu_ms) {
            double& least = way.stages.try_emplace(stage.name, 1e30).first->second;
            least = std::min(least, stage.ms);
        }
        return ms;
    };
    for (Frames& way : ways)
        for (int i = 0; i < 2; ++i) frame(way);  // compiles the shaders
    for (auto _ : state) {
        for (Frames& way : ways) way.least_ms = std::min(way.least_ms, frame(way));
        state.SetIterationTime(ways[1].least_ms * 1e-3);
    }
    state.counters["full_cpu_ms"] = ways[0].least_ms;
    state.counters["foveated_cpu_ms"] = ways[1].least_ms;
    for (const auto& [name, ms] : ways[0].stages) state.counters["full." + name] = ms;
    for (const auto& [name, ms] : ways[1].stages) state.counters["fov." + name] = ms;
    state.counters["foveated"] = ways[1].path->stage()->foveated();
}

constexpr auto exact = perception::FoveationInverse::exact;
constexpr auto fitted = perception::FoveationInverse::fitted;
void once(benchmark::internal::Benchmark* b) { b->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(5); }
BENCHMARK_CAPTURE(foveated_frame, 720x800_exact_2, {720, 800}, exact, 2, "combined")->Apply(once);
BENCHMARK_CAPTURE(foveated_frame, 720x800_fitted_2, {720, 800}, fitted, 2, "combined")->Apply(once);
BENCHMARK_CAPTURE(foveated_frame, 720x800_exact_3, {720, 800}, exact, 3, "combined")->Apply(once);
BENCHMARK_CAPTURE(foveated_frame, 720x800_jacobs2015, {720, 800}, exact, 2, "jacobs2015")->Apply(once);
BENCHMARK_CAPTURE(foveated_frame, 1440x1600_exact_2, {1440, 1600}, exact, 2, "combined")->Apply(once);
BENCHMARK_CAPTURE(foveated_frame, 1440x1600_exact_3, {1440, 1600}, exact, 3, "combined")->Apply(once);

}  // namespace
}  // namespace entoptic::compositor
