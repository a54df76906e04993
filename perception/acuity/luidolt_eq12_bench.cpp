// Time of the acuity loss for both eyes of a headset: a whole night picture is blurred, dusk in part, day not at all.
#include "perception/testing/stage_bench.h"

namespace entoptic::perception {
namespace {

using namespace testing;

void AcuityLuidoltEq12(benchmark::State& state) {
    const double light = std::pow(10, static_cast<double>(state.range(0)));
    const ImageF picture = textured(1440, 1600, light);
    const std::string as_printed = "acuity.as_printed=" + std::to_string(state.range(1));
    time_effect(state, vive_lens(), picture, only({"acuity=luidolt_eq12"}, {as_printed}), "perceive.acuity");
}
BENCHMARK(AcuityLuidoltEq12)
    ->ArgNames({"log10_cd_m2", "as_printed"})
    ->Args({-3, 0})
    ->Args({-1, 0})
    ->Args({0, 0})
    ->Args({3, 0})
    ->Args({-3, 1})
    ->Iterations(8)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

// One dark corner, a ninth of the picture, in a bright room: only its tiles work.
void AcuityLuidoltEq12DarkCorner(benchmark::State& state) {
    ImageF picture = uniform(1440, 1600, 50);
    for (int y = 400; y < 933; ++y)
        for (int x = 400; x < 880; ++x)
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 0.01f;
    time_effect(state, vive_lens(), picture, only({"acuity=luidolt_eq12"}), "perceive.acuity");
}
BENCHMARK(AcuityLuidoltEq12DarkCorner)->Iterations(8)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
