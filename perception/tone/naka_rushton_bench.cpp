// Time of the tone map for both eyes of a headset.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void ToneNakaRushton(benchmark::State& state) {
    const ImageF picture = textured(1440, 1600, 10, 1e6);
    time_effect(state, vive_lens(), picture, only({"adaptation=krawczyk_exp_log", "tone=naka_rushton"}), "perceive.tone");
}
BENCHMARK(ToneNakaRushton)->Iterations(8)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
