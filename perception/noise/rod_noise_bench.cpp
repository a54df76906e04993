// Time of the noise for both eyes of a headset: a night picture brightened, and one shown as it is, for which the gate leaves it out.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void NoiseRodNoise(benchmark::State& state) {
    time_brightened(state, only({"adaptation=krawczyk_exp_log", "noise=rod_noise"}), "perceive.noise");
}
BENCHMARK(NoiseRodNoise)
    ->ArgNames({"log10_cd_m2", "brightened"})
    ->Args({-3, 1})
    ->Args({-3, 0})
    ->Iterations(8)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
