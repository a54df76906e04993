// Time of depth of field for both eyes of a headset.
#include "perception/testing/dof_bench.h"

namespace entoptic::perception {
namespace {

void DofLiuRange(benchmark::State& state) { testing::time_dof(state, "liu_range"); }
BENCHMARK(DofLiuRange)->Apply(testing::dof_settings);

}  // namespace
}  // namespace entoptic::perception
