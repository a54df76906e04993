// Time of the blur by local means for both eyes of a headset: a night picture brightened, at which the whole picture is blurred, and a
// picture shown as it is, for which the gate leaves it out.
#include "perception/testing/exposure.h"
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void AcuityLarsonIncrement(benchmark::State& state) {
    const double light = std::pow(10, static_cast<double>(state.range(0)));
    const float exposure = state.range(1) ? static_cast<float>(1 / light) : 1.0f;
    const ImageF picture = textured(1440, 1600, light);
    time_effect(state, vive_lens(), picture, with_exposure(only({"acuity=larson_increment"}), exposure), "perceive.acuity");
}
BENCHMARK(AcuityLarsonIncrement)
    ->ArgNames({"log10_cd_m2", "brightened"})
    ->Args({-5, 1})
    ->Args({-3, 1})
    ->Args({-1, 1})
    ->Args({-1, 0})
    ->Iterations(4)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
