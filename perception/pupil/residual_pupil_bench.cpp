// Time of the pupil model, on the CPU: nothing is recorded.
#include "perception/testing/harness.h"

#include <benchmark/benchmark.h>

namespace entoptic::perception {
namespace {

void PupilResidual(benchmark::State& state) {
    const ModelEntry& entry = *find_model("pupil", "residual_pupil");
    auto model = testing::value(entry.create({testing::device(), {testing::rectilinear(8, 8, 60), testing::rectilinear(8, 8, 60)}, {}, 1}));
    model->set_parameters(default_parameters(entry));
    const SceneFeedback feedback[2] = {{0.01, 1, 8495}, {0.01, 1, 8495}};
    for (auto _ : state) {
        FrameInput input = testing::still_input(2);
        dynamic_cast<AdjustsEyes&>(*model).adjust(input, feedback);
        benchmark::DoNotOptimize(input.eyes[0].pupil_diameter_mm);
    }
}
BENCHMARK(PupilResidual);

}  // namespace
}  // namespace entoptic::perception
