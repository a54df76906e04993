// Time of the tone map for both eyes of a headset; it always runs.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void ToneKeyReinhard(benchmark::State& state) {
    const ImageF picture = textured(1440, 1600, 10, 1e6);
    time_effect(state, vive_lens(), picture, only({"adaptation=krawczyk_exp_linear", "tone=key_reinhard"}), "perceive.tone");
}
BENCHMARK(ToneKeyReinhard)->Iterations(8)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
