// Time of the open lid, which the gate leaves out, for both eyes of a headset.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void EyelidBlink(benchmark::State& state) {
    time_effect(state, vive_lens(), textured(1440, 1600, 10), only({"eyelid=blink"}), "perceive.eyelid");
}
BENCHMARK(EyelidBlink)->Iterations(8)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
