// Time of cie135 for both eyes of a headset: lamps above the panel's white, a scene within it.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void GlareCie135(benchmark::State& state) {
    time_effect(state, vive_lens(), textured(1440, 1600, 1, state.range(0) ? 1e6 : 0), only({"adaptation=krawczyk_exp_linear", "glare=cie135"}), "perceive.glare");
}
BENCHMARK(GlareCie135)->ArgName("lamp")->Arg(1)->Arg(0)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(5);

}  // namespace
}  // namespace entoptic::perception
