// Time of adaptation for both eyes of a headset. Its cost is that of the tiles, whatever the picture and the parameters.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void AdaptationJacobsRamp(benchmark::State& state) {
    const ImageF picture = textured(1440, 1600, 10, 1e6);
    time_effect(state, vive_lens(), picture, only({"adaptation=jacobs_ramp"}), "perceive.adaptation");
}
BENCHMARK(AdaptationJacobsRamp)->Iterations(8)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
