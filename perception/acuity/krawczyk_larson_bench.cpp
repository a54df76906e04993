// Time of the blur by pixel for both eyes of a headset: at night and at dusk.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void AcuityKrawczykLarson(benchmark::State& state) {
    const ImageF picture = textured(1440, 1600, std::pow(10, static_cast<double>(state.range(0))));
    time_effect(state, vive_lens(), picture, only({"acuity=krawczyk_larson"}), "perceive.acuity");
}
BENCHMARK(AcuityKrawczykLarson)->ArgName("log10_cd_m2")->Arg(-3)->Arg(-1)->Arg(3)->Iterations(2)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
