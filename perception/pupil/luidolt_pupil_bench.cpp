// Time of the pupil model, on the CPU: nothing is recorded.
#include "perception/testing/pupil_bench.h"

namespace entoptic::perception {
namespace {

void PupilLuidolt(benchmark::State& state) { testing::time_pupil(state, "luidolt_pupil"); }
BENCHMARK(PupilLuidolt);

}  // namespace
}  // namespace entoptic::perception
