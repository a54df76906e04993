// For the benches of the slot `pupil`: time of a model on the CPU, where nothing is recorded. Header-only.
#pragma once

#include "perception/testing/harness.h"

#include <benchmark/benchmark.h>

namespace entoptic::perception::testing {

inline void time_pupil(benchmark::State& state, const char* name) {
    const ModelEntry& entry = *find_model("pupil", name);
    auto model = value(entry.create({device(), {rectilinear(8, 8, 60), rectilinear(8, 8, 60)}, {}, 1}));
    model->set_parameters(default_parameters(entry));
    const SceneFeedback feedback[2] = {{0.01, 1, 8495}, {0.01, 1, 8495}};
    for (auto _ : state) {
        FrameInput input = still_input(2);
        dynamic_cast<AdjustsEyes&>(*model).adjust(input, feedback);
        benchmark::DoNotOptimize(input.eyes[0].pupil_diameter_mm);
    }
}

}  // namespace entoptic::perception::testing
