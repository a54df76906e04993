// Time of depth of field for both eyes of a headset: a room with near things in focus and the far ones blurred, one where all is in focus.
#include "perception/testing/dof_scenes.h"
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void DofDioptricDisc(benchmark::State& state) {
    const ImageF picture = textured(1440, 1600, 50);
    const bool in_focus = state.range(0) == 0;
    const ImageF depth = in_focus ? distance(1440, 1600, 2) : floor_with_post(1440, 1600, 0.4f, 30, 1);
    const std::vector<std::string> settings = {"dof.focus_dioptre=" + std::string(in_focus ? "0.5" : "2"),
                                               "dof.roulette=" + std::to_string(state.range(1)),
                                               "dof.lca=" + std::to_string(state.range(2))};
    time_effect(state, vive_lens(), picture, only({"dof=dioptric_disc"}, settings), "perceive.dof", depth);
}
BENCHMARK(DofDioptricDisc)
    ->ArgNames({"blurred", "roulette", "lca"})
    ->Args({0, 0, 0})
    ->Args({1, 0, 0})
    ->Args({1, 1, 0})
    ->Args({1, 0, 1})
    ->Iterations(4)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
