// Time of depth of field for both eyes of a headset.
#include "perception/testing/dof_bench.h"

namespace entoptic::perception {
namespace {

void DofDioptricDisc(benchmark::State& state) { testing::time_dof(state, "dioptric_disc"); }
BENCHMARK(DofDioptricDisc)->Apply(testing::dof_settings);

}  // namespace
}  // namespace entoptic::perception
