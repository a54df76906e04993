// Time of the tint by pixel for both eyes of a headset: at night it runs, by day the gate leaves it out.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void MesopicKrawczykTint(benchmark::State& state) {
    const double light = std::pow(10, static_cast<double>(state.range(0)));
    const ImageF picture = textured(1440, 1600, light);
    time_effect(state, vive_lens(), picture, only({"mesopic=krawczyk_tint"}, {"mesopic.photographic=1"}), "perceive.mesopic");
}
BENCHMARK(MesopicKrawczykTint)->ArgName("log10_cd_m2")->Arg(-2)->Arg(5)->Iterations(8)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
