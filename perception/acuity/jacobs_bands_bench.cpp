// Time of the blur by local means for both eyes of a headset: a night picture brightened, at which the whole picture is blurred, and a
// picture shown as it is, for which the gate leaves it out.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void AcuityJacobsBands(benchmark::State& state) { time_brightened(state, only({"acuity=jacobs_bands"}), "perceive.acuity"); }
BENCHMARK(AcuityJacobsBands)
    ->ArgNames({"log10_cd_m2", "brightened"})
    ->Args({-3, 1})
    ->Args({-1, 1})
    ->Args({-1, 0})
    ->Iterations(4)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
