// Time of closed_form for both eyes of a headset: lamps above the panel's white, with and without the re-scatter; a person who is not the
// wearer; a scene within the panel's white.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void time(benchmark::State& state, double lamp, const std::vector<std::string>& settings) {
    time_effect(state, vive_lens(), textured(1440, 1600, 1, lamp), only({"adaptation=krawczyk_exp_linear", "glare=closed_form"}, settings), "perceive.glare");
}
void GlareClosedForm(benchmark::State& state) { time(state, 1e6, {"glare.rescatter=" + std::to_string(state.range(0))}); }
BENCHMARK(GlareClosedForm)->ArgName("rescatter")->Arg(1)->Arg(0)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(5);
void GlareClosedFormOtherPerson(benchmark::State& state) { time(state, 1e6, {"glare.age=70", "glare.wearer_age=30"}); }
BENCHMARK(GlareClosedFormOtherPerson)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(5);
void GlareClosedFormGated(benchmark::State& state) { time(state, 0, {}); }
BENCHMARK(GlareClosedFormGated)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(5);

}  // namespace
}  // namespace entoptic::perception
