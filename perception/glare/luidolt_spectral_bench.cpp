// Time of the glare for both eyes of a headset: a scene with lamps, one inside the gate, a pupil that moves; and of its settings.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

// Two lamps on a texture of about 1 cd/m².
ImageF lamps() {
    ImageF image = textured(1440, 1600, 1, 1e6);
    for (int y = 900; y < 912; ++y)
        for (int x = 800; x < 812; ++x) image.at(x, y, 0) = 1e5f, image.at(x, y, 1) = 6e4f, image.at(x, y, 2) = 2e4f;
    return image;
}
Selection glare(const std::vector<std::string>& settings) { return only({"adaptation=krawczyk_exp_linear", "glare=luidolt_spectral"}, settings); }

// The default; `near_from` 0: all light has a near field.
void GlareLuidoltSpectral(benchmark::State& state) {
    time_effect(state, vive_lens(), lamps(), glare({"glare.near_from=" + std::to_string(state.range(0))}), "perceive.glare");
}
BENCHMARK(GlareLuidoltSpectral)->ArgName("near_from")->Arg(16)->Arg(0)->UseManualTime()->Unit(benchmark::kMillisecond);

// Nothing to scatter: the gate leaves it out.
void GlareLuidoltSpectralGated(benchmark::State& state) {
    time_effect(state, vive_lens(), uniform(1440, 1600, 1), glare({}), "perceive.glare");
}
BENCHMARK(GlareLuidoltSpectralGated)->UseManualTime()->Unit(benchmark::kMillisecond);

// A new kernel every frame: the pupil goes 0.2 mm a frame, twice as fast as an eye can.
void GlareLuidoltSpectralRebuild(benchmark::State& state) {
    StageRunner runner({vive_lens(), vive_lens()}, glare({"glare.near_px=0"}));
    FrameInput input = still_input(2);
    const std::vector<ImageF> pictures(2, lamps());
    runner.run(pictures, input);
    int frame = 0;
    for (auto _ : state) {
        for (EyeInput& eye : input.eyes) eye.pupil_diameter_mm = 3.01f + 0.2f * static_cast<float>(++frame % 20);
        runner.run(pictures, input);
        for (const gpu::StageTime& stage : runner.commands().stage_times())
            if (stage.name == "perceive.glare") state.SetIterationTime(stage.ms * 1e-3);
    }
}
BENCHMARK(GlareLuidoltSpectralRebuild)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
