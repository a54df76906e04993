// For the benches of the slot `dof`. Header-only.
#pragma once

#include "perception/testing/dof_scenes.h"
#include "perception/testing/stage_bench.h"

namespace entoptic::perception::testing {

// A room with near things in focus and the far ones blurred (range(0) is 1), or one where all is in focus; sampled discs with range(1), and
// coloured edges with range(2).
inline void time_dof(benchmark::State& state, const char* model) {
    const bool in_focus = state.range(0) == 0;
    const ImageF depth = in_focus ? distance(1440, 1600, 2) : floor_with_post(1440, 1600, 0.4f, 30, 1);
    const std::vector<std::string> settings = {"dof.focus_dioptre=" + std::string(in_focus ? "0.5" : "2"),
                                               "dof.roulette=" + std::to_string(state.range(1)),
                                               "dof.lca=" + std::to_string(state.range(2))};
    time_effect(state, vive_lens(), textured(1440, 1600, 50), only({std::string("dof=") + model}, settings), "perceive.dof", depth);
}
// The settings that time_dof() is asked for.
inline void dof_settings(benchmark::internal::Benchmark* bench) {
    bench->ArgNames({"blurred", "roulette", "lca"})->Args({0, 0, 0})->Args({1, 0, 0})->Args({1, 1, 0})->Args({1, 0, 1});
    bench->Iterations(4)->UseManualTime()->Unit(benchmark::kMillisecond);
}

}  // namespace entoptic::perception::testing
