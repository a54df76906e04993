// Time of the pupil model, on the CPU: nothing is recorded.
#include "perception/testing/pupil_bench.h"

namespace entoptic::perception {
namespace {

void PupilResidual(benchmark::State& state) { testing::time_pupil(state, "residual_pupil"); }
BENCHMARK(PupilResidual);

}  // namespace
}  // namespace entoptic::perception
