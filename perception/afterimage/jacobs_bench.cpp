// Time of afterimages for both eyes of a headset: at dusk the gate leaves them out, a lamp that the panel cannot show makes them run.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void AfterimageJacobs(benchmark::State& state, const char* part) {
    const ImageF picture = textured(1440, 1600, 1, state.range(0) ? 1e6 : 0);
    time_effect(state, vive_lens(), picture, only({"afterimage=jacobs"}), part);
}
void Observe(benchmark::State& state) { AfterimageJacobs(state, "perceive.afterimage.observe"); }
void Apply(benchmark::State& state) { AfterimageJacobs(state, "perceive.afterimage"); }
BENCHMARK(Observe)->Name("AfterimageJacobsObserve")->ArgName("lamp")->Arg(0)->Arg(1)->Iterations(8)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(Apply)->Name("AfterimageJacobsApply")->ArgName("lamp")->Arg(0)->Arg(1)->Iterations(8)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
