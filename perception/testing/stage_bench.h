// For benches: GPU time of one effect on a headset's two eyes. Header-only.
#pragma once

#include "perception/testing/exposure.h"
#include "perception/testing/harness.h"
#include "perception/testing/scenes.h"

#include <algorithm>
#include <benchmark/benchmark.h>
#include <ctime>

namespace entoptic::perception::testing {

// Runs frames; the time is that of the stage `effect` ("perceive.acuity") alone, by GPU timestamps. Two eyes of `geometry` look at one
// picture, `depth` metres away (empty: unknown). Counters: `gated` is 1 when the GPU left the effect out; `least_ms` the fastest frame;
// `cpu_ms` the processor time of all threads that the selection adds to a frame without any model (fastest of each): on a software renderer
// the one figure that a busy machine does not change. Give the benchmark a fixed number of iterations: a gated effect takes microseconds, its
// frame does not.
inline void time_effect(benchmark::State& state, const EyeGeometry& geometry, const ImageF& picture, const Selection& selection,
                        const std::string& effect, const ImageF& depth = {}) {
    StageRunner runner({geometry, geometry}, selection), without({geometry, geometry}, only({}));
    const std::vector<ImageF> pictures = {picture, picture};
    const std::vector<ImageF> depths(depth.data.empty() ? 0 : 2, depth);
    const auto cpu_ms = [&](StageRunner& of) {
        const std::clock_t start = std::clock();
        of.run(pictures, still_input(2, 1.0 / 90, false), depths);
        return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    };
    cpu_ms(runner);  // compiles the shaders
    cpu_ms(without);
    double least = 1e30, cpu = 1e30, cpu_without = 1e30;
    for (auto _ : state) {
        cpu_without = std::min(cpu_without, cpu_ms(without));
        cpu = std::min(cpu, cpu_ms(runner));
        double ms = 0;
        for (const gpu::StageTime& time : runner.commands().stage_times()) ms += time.name == effect ? time.ms : 0;
        state.SetIterationTime(ms * 1e-3);
        least = std::min(least, ms);
    }
    state.counters["least_ms"] = least;
    state.counters["cpu_ms"] = cpu - cpu_without;
    for (const EffectOutcome& outcome : runner.stage().effects())
        if ("perceive." + outcome.slot == effect) state.counters["gated"] = outcome.gated ? 1 : 0;
}

// A headset's two eyes and a picture of 10^range(0) cd/m², which the display shows at 1 cd/m² when range(1) is 1, and as it is when it is 0.
inline void time_brightened(benchmark::State& state, const Selection& selection, const std::string& effect) {
    const double light = std::pow(10, static_cast<double>(state.range(0)));
    const float exposure = state.range(1) ? static_cast<float>(1 / light) : 1.0f;
    time_effect(state, vive_lens(), textured(1440, 1600, light), with_exposure(selection, exposure), effect);
}

}  // namespace entoptic::perception::testing
