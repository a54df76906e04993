// Time of rod vision for both eyes of a headset: at night it runs, by day the gate leaves it out.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void MesopicMes2(benchmark::State& state) {
    const double light = std::pow(10, static_cast<double>(state.range(0)));
    const ImageF picture = textured(1440, 1600, light);
    time_effect(state, vive_lens(), picture, only({"mesopic=mes2"}, {"mesopic.photographic=1"}), "perceive.mesopic");
}
BENCHMARK(MesopicMes2)->ArgName("log10_cd_m2")->Arg(-2)->Arg(4)->Iterations(8)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
