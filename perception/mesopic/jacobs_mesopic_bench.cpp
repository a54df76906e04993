// Time of rod vision for both eyes of a headset: at night it runs, by day the gate leaves it out.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void MesopicJacobs(benchmark::State& state) {
    const double light = std::pow(10, static_cast<double>(state.range(0)));
    const ImageF picture = textured(1440, 1600, light);
    time_effect(state, vive_lens(), picture, only({"mesopic=jacobs_mesopic"}, {"mesopic.photographic=1"}), "perceive.mesopic");
}
BENCHMARK(MesopicJacobs)->ArgName("log10_cd_m2")->Arg(-2)->Arg(4)->Iterations(8)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
